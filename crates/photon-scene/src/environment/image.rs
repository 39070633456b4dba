//! Environments from image files.

use std::path::Path;

use super::EnvironmentDesc;
use crate::error::SceneError;
use crate::load::budget::Budget;
use crate::load::{Image, LoadOptions, image_header, load_image};
use crate::report::LoadReport;

impl EnvironmentDesc {
    /// Reads an image in latitude and longitude: `OpenEXR` or Radiance HDR with radiance in W/(m²·sr), or PNG, JPEG or
    /// WebP, whose sRGB colours become radiances from 0 to 1. The report gets a note if the image has only 8 or 16 bits,
    /// and a line if it had texels that were negative or NaN, which become 0.
    ///
    /// # Errors
    /// Those of [`load_image`]; [`SceneError::Environment`] for an infinite texel.
    pub fn read(path: &Path, report: &mut LoadReport) -> Result<Self, SceneError> {
        Self::read_within(path, report, &Budget::unlimited())
    }

    /// Reads an image with options: a limit on memory.
    ///
    /// # Errors
    /// Those of [`Self::read`], and [`SceneError::Memory`] for an image that does not fit, before it is decoded.
    pub fn read_with(path: &Path, report: &mut LoadReport, options: &LoadOptions) -> Result<Self, SceneError> {
        Self::read_within(path, report, &Budget::new(options))
    }

    pub(crate) fn read_within(path: &Path, report: &mut LoadReport, budget: &Budget) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        if let Some((header, file)) = image_header(path, budget)? {
            // Before texels are decoded, which may take gigabytes.
            Self::check_shape(&name, header.size.map(|side| side as usize))?;
            let needed = file + header.with_colors();
            budget.check(needed, || "the image of the environment".to_owned()).map_err(|why| why.in_file(path))?;
        }
        Self::of_image(name, &load_image(path)?, report)
    }

    fn of_image(name: String, image: &Image, report: &mut LoadReport) -> Result<Self, SceneError> {
        let subject = format!("environment '{name}'");
        let radiance = image.linear_rgb();
        let desc = Self::image(name, image.width as usize, radiance);
        for remark in &image.remarks {
            report.approximated(&subject, format!("its image {remark}"));
        }
        if !image.is_float {
            report.note(
                subject,
                "is an image of display colours: they are decoded from sRGB to radiances of at most 1, and light sources \
                 in it are too dim; use an OpenEXR or Radiance HDR file",
            );
            return Ok(desc);
        }
        let super::EnvironmentSource::Image { radiance, .. } = &desc.source else { return Ok(desc) };
        if image.repaired > 0 {
            // The decoder replaces infinities by the largest number.
            if let Some(at) = radiance.iter().position(|texel| texel.contains(&f32::MAX)) {
                let (column, row) = (at as u32 % image.width, at as u32 / image.width);
                let what = format!("the texel in column {column}, row {row} is infinite");
                return Err(desc.fault(what, "limit the values of the image, to 65504 for instance"));
            }
            report.approximated(subject, format!("{} texels were negative or not a number, and are 0", image.repaired));
        }
        Ok(desc)
    }
}
