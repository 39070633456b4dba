//! Compiles GLSL to SPIR-V 1.5 for Vulkan 1.2.

use std::path::{Path, PathBuf};

use glslang::include::{IncludeHandler, IncludeResult, IncludeType};
use glslang::{
    Compiler, CompilerOptions, GlslProfile, ShaderInput, ShaderMessage, ShaderSource, ShaderStage, SourceLanguage,
    SpirvVersion, Target, VulkanVersion,
};

use crate::sources::{Shader, read};
use crate::{no_contraction, parameters};

/// Resolves `#include "folder/stem.glsl"` within one folder.
struct Includes<'a> {
    folder: &'a Path,
}

impl IncludeHandler for Includes<'_> {
    fn include(&mut self, _: IncludeType, name: &str, _: &str, _: usize) -> Option<IncludeResult> {
        let path: PathBuf = self.folder.join(name);
        read(&path).ok().map(|data| IncludeResult { name: name.to_owned(), data })
    }
}

/// The SPIR-V words of one kernel.
///
/// # Errors
/// The compiler's errors.
pub(crate) fn compile(kernel: &Shader, includes: &Path) -> Result<Vec<u32>, String> {
    let compiler = Compiler::acquire().ok_or("the compiler does not start")?;
    let source = ShaderSource::from(kernel.text.clone());
    let options = CompilerOptions {
        source_language: SourceLanguage::GLSL,
        target: Target::Vulkan { version: VulkanVersion::Vulkan1_2, spirv_version: SpirvVersion::SPIRV1_5 },
        version_profile: Some((460, GlslProfile::None)),
        messages: ShaderMessage::SPV_RULES | ShaderMessage::VULKAN_RULES,
    };
    let mut handler = Includes { folder: includes };
    let defines: Option<&[(&str, Option<&str>)]> = None;
    let input = ShaderInput::new(&source, ShaderStage::Compute, &options, defines, Some(&mut handler))
        .map_err(|error| error.to_string())?;
    let shader = compiler.create_shader(input).map_err(|error| error.to_string())?;
    shader
        .compile()
        .map(|words| parameters::decorate(&no_contraction::decorate(&words)))
        .map_err(|error| error.to_string())
}
