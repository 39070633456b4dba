//! Scenes: what the renderer is given.
