//! Photon maps, built on the device.
