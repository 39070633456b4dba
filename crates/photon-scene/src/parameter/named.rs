//! Materials from the names of override files, for other languages.

use super::{Field, Kind, PARAMETERS, Parameter};
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::similar;

impl MaterialDesc {
    /// A material of a kind with parameters of the surface and its layers, by their names in override files
    /// (`docs/scene-files.md`): numbers and colours, of which one number is grey. Angles are in degrees. Emission, alpha,
    /// phase function, dispersion, priority and grid are fields. Ranges are checked by [`crate::SceneBuilder::build`].
    ///
    /// # Errors
    /// [`SceneError::Parameter`] for an unknown kind, a parameter that the kind does not have, and another number of numbers.
    /// A glossy material has an absorption only with a transmission.
    pub fn with_parameters<'a>(
        name: impl Into<String>,
        kind: &str,
        parameters: impl IntoIterator<Item = (&'a str, &'a [f64])>,
    ) -> Result<Self, SceneError> {
        let name = name.into();
        let fault = |what: String, hint| SceneError::Parameter { material: name.clone(), what, hint };
        let Some(kind) = Kind::ALL.into_iter().find(|known| known.name() == kind) else {
            let what = format!("there is no kind '{kind}'");
            return Err(fault(what, similar::did_you_mean(kind, Kind::ALL.map(Kind::name))));
        };
        let mut desc = Self::new(name.clone(), kind.surface());
        for (key, numbers) in parameters {
            let Some(parameter) = Parameter::find(key) else {
                let what = format!("there is no parameter '{key}'");
                return Err(fault(what, similar::did_you_mean(key, PARAMETERS.iter().map(|parameter| parameter.key))));
            };
            let has_absorption = key == "absorption" && kind == Kind::Glossy;
            if !has_absorption && !parameter.is_of(&desc) {
                let what = format!("{} has no {key}", kind.name());
                return Err(fault(what, format!("{} it; leave it out", parameter.kinds_with())));
            }
            let mut absorption = [0.0; 3];
            let field =
                if has_absorption { Some(Field::Color(&mut absorption)) } else { (parameter.access)(&mut desc) };
            match (field, numbers) {
                (Some(Field::Number(number)), &[value]) => {
                    *number = if parameter.is_angle { value.to_radians() } else { value };
                }
                (Some(Field::Color(color)), &[grey]) => *color = [grey; 3],
                (Some(Field::Color(color)), &[r, g, b]) => *color = [r, g, b],
                _ => {
                    let what = format!("{key} is {numbers:?}");
                    return Err(fault(what, "it must be a number, or three of a colour".to_owned()));
                }
            }
            if has_absorption {
                desc.transmission_absorption = Some(absorption);
            }
        }
        if desc.transmission_absorption.is_some() && desc.transmission == 0.0 {
            return Err(fault(
                "it is glossy without transmission and has no absorption".to_owned(),
                "leave it out".to_owned(),
            ));
        }
        Ok(desc)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::describe::Surface;

    #[test]
    fn parameters_have_the_names_of_files() {
        let given: [(&str, &[f64]); 5] = [
            ("albedo", &[0.25]),
            ("sheen", &[0.5, 0.25, 1.0]),
            ("anisotropy_degrees", &[180.0]),
            ("absorption", &[2.0]),
            ("transmission", &[0.5]),
        ];
        let desc = MaterialDesc::with_parameters("cloth", "glossy", given).unwrap();
        assert!(matches!(desc.surface, Surface::Glossy { base_color: [0.25, 0.25, 0.25], .. }));
        assert_eq!((desc.sheen_color, desc.anisotropy_rotation), ([0.5, 0.25, 1.0], std::f64::consts::PI));
        assert_eq!(desc.transmission_absorption, Some([2.0; 3]));
    }

    /// The name of the material, what is wrong, and the remedy.
    #[test]
    fn other_names_are_refused() {
        let refused: [(&str, &str, &[f64], &str); 6] = [
            ("glas", "ior", &[1.5], "there is no kind 'glas'; did you mean 'glass'?"),
            ("glass", "iro", &[1.5], "there is no parameter 'iro'; did you mean 'ior'?"),
            ("glass", "sheen", &[1.0], "glass has no sheen; lambert, mirror and glossy have it; leave it out"),
            ("glass", "ior", &[1.5; 3], "ior is [1.5, 1.5, 1.5]; it must be a number"),
            ("glossy", "absorption", &[1.0], "glossy without transmission and has no absorption; leave it out"),
            ("lambert", "albedo", &[], "albedo is []; it must be a number, or three of a colour"),
        ];
        for (kind, key, numbers, expected) in refused {
            let found = MaterialDesc::with_parameters("a", kind, [(key, numbers)]).unwrap_err().to_string();
            assert!(found.starts_with("material 'a': ") && found.contains(expected), "{found}");
        }
    }
}
