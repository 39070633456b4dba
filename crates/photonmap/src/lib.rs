//! Photon mapping on the CPU and on GPUs: the crates of the project under one name.
//!
//! | here | crate |
//! |---|---|
//! | [`Pipeline`], [`render`], [`Settings`], [`Film`] and all else at the top | `photonmap-core` |
//! | [`scene`] | `photonmap-scene`: scene builder, loaders (feature `files`), built-in scenes |
//! | `film` (feature `files`) | `photonmap-film`: films in files |
//! | `cpu` (feature `cpu`) | `photonmap-cpu` |
//! | `vulkan` (feature `vulkan`) | `photonmap-vulkan` |
//!
//! All features are on by default. A renderer with its own scenes and its own device needs fewer: without `files`, no
//! parser is compiled; without `vulkan`, nothing of Vulkan.
//!
//! ```
//! use photonmap::cpu::Cpu;
//! use photonmap::{Budget, Pipeline, Render, Settings, View, render, scene};
//!
//! let scene = scene::builtin("cornell").expect("listed").build()?;
//! let view = View { camera: scene.camera(None, 16, 16)?, width: 16, height: 16 };
//! let settings = Settings { photons: 10_000, ..Settings::default() };
//! let mut renderer = Pipeline::new(Cpu::new()?, &scene.view(), view, settings)?;
//! render(&mut renderer, Budget::passes(1), &mut ())?;
//! // Radiance in W/(m²·sr), linear RGB, top row first.
//! let picture: Vec<[f32; 3]> = renderer.film()?.beauty();
//! assert_eq!(picture.len(), 16 * 16);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub use photon_core::*;
pub use photon_scene as scene;

#[cfg(feature = "files")]
pub use photon_film as film;

#[cfg(feature = "cpu")]
pub use backend_cpu as cpu;
#[cfg(feature = "vulkan")]
pub use backend_vulkan as vulkan;

/// The example in the README, compiled and run as a doctest; not part of the library.
#[cfg(all(doctest, feature = "cpu"))]
#[doc = include_str!("../README.md")]
struct Readme;
