"""Error over processor time of photonmap beside renderers that install from package registries."""
