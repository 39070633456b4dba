//! The C interface of Open Image Denoise 2, loaded at run time.
#![expect(unsafe_code, reason = "calls functions of a C library")]

use std::ffi::{CStr, CString, OsString, c_char, c_int, c_void};
use std::path::Path;

use libloading::Library;

use super::installed::by_pip;

/// Environment variable with the path of the library.
pub(super) const VARIABLE: &str = "PHOTON_OIDN";

/// Names that are looked for in the search path of the system, after the variable and the packages of Python.
const NAMES: [&str; 4] =
    ["libOpenImageDenoise.so.2", "libOpenImageDenoise.so", "libOpenImageDenoise.2.dylib", "OpenImageDenoise.dll"];

/// `OIDN_DEVICE_TYPE_CPU`: it reads and writes our own memory.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;

type Handle = *mut c_void;

/// The functions that are used, by their names without the prefix `oidn`.
#[expect(non_snake_case, reason = "the names of the C interface")]
struct Functions {
    NewDevice: unsafe extern "C" fn(c_int) -> Handle,
    CommitDevice: unsafe extern "C" fn(Handle),
    ReleaseDevice: unsafe extern "C" fn(Handle),
    GetDeviceInt: unsafe extern "C" fn(Handle, *const c_char) -> c_int,
    GetDeviceError: unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int,
    NewFilter: unsafe extern "C" fn(Handle, *const c_char) -> Handle,
    ReleaseFilter: unsafe extern "C" fn(Handle),
    SetSharedFilterImage:
        unsafe extern "C" fn(Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize),
    SetFilterBool: unsafe extern "C" fn(Handle, *const c_char, bool),
    CommitFilter: unsafe extern "C" fn(Handle),
    ExecuteFilter: unsafe extern "C" fn(Handle),
}

impl Functions {
    fn of(library: &Library) -> Result<Self, libloading::Error> {
        macro_rules! functions {
            ($($name:ident),*) => {
                Self {
                    $(
                        // SAFETY: the type is that of the header of version 2. `Oidn` keeps the library loaded for as
                        // long as the pointer.
                        $name: *unsafe { library.get(concat!("oidn", stringify!($name), "\0").as_bytes()) }?,
                    )*
                }
            };
        }
        Ok(functions!(
            NewDevice,
            CommitDevice,
            ReleaseDevice,
            GetDeviceInt,
            GetDeviceError,
            NewFilter,
            ReleaseFilter,
            SetSharedFilterImage,
            SetFilterBool,
            CommitFilter,
            ExecuteFilter
        ))
    }
}

/// The loaded library.
pub(super) struct Oidn {
    functions: Functions,
    _library: Library,
}

/// A device that is released at the end.
struct Device<'a>(&'a Functions, Handle);

impl Drop for Device<'_> {
    fn drop(&mut self) {
        // SAFETY: a device that `NewDevice` returned, released once.
        unsafe { (self.0.ReleaseDevice)(self.1) }
    }
}

impl Device<'_> {
    /// The error since the last call, if there is one.
    fn check(&self) -> Result<(), String> {
        let mut message = std::ptr::null();
        // SAFETY: a valid device; `message` receives a pointer to a string that lives until the next call.
        let code = unsafe { (self.0.GetDeviceError)(self.1, &raw mut message) };
        if code == 0 {
            return Ok(());
        }
        if message.is_null() {
            return Err(format!("error {code}"));
        }
        // SAFETY: a C string, see above.
        Err(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned())
    }
}

/// A filter that is released at the end.
struct Filter<'a>(&'a Functions, Handle);

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: a filter that `NewFilter` returned, released once, before its device.
        unsafe { (self.0.ReleaseFilter)(self.1) }
    }
}

impl Oidn {
    /// Loads it from the file that [`VARIABLE`] names, else from the packages of Python, of this environment first, or the
    /// search path.
    pub(super) fn load(environment: Option<&Path>) -> Result<Self, String> {
        let named = std::env::var_os(VARIABLE).filter(|name| !name.is_empty());
        let names: Vec<OsString> = match named {
            Some(name) => vec![name],
            None => {
                by_pip(environment).into_iter().map(OsString::from).chain(NAMES.iter().map(OsString::from)).collect()
            }
        };
        let mut why = String::new();
        for name in names {
            // SAFETY: loading a library runs its initialisers; this one is asked for by the user.
            match unsafe { Library::new(&name) } {
                Ok(library) => {
                    let functions = Functions::of(&library).map_err(|error| {
                        format!("{}: not version 2 of the library: {error}", name.to_string_lossy())
                    })?;
                    return Ok(Self { functions, _library: library });
                }
                Err(error) if why.is_empty() => why = error.to_string(),
                Err(_) => {}
            }
        }
        Err(why)
    }

    /// Denoises linear colours of any range by noisy albedos and normals, on the CPU. Returns the version of the library too.
    ///
    /// All have `width · height` pixels.
    pub(super) fn denoise(
        &self,
        (width, height): (usize, usize),
        mut color: Vec<[f32; 3]>,
        mut albedo: Vec<[f32; 3]>,
        mut normal: Vec<[f32; 3]>,
    ) -> Result<(Vec<[f32; 3]>, String), String> {
        let pixels = width.checked_mul(height).filter(|&pixels| {
            pixels > 0 && [color.len(), albedo.len(), normal.len()].iter().all(|&length| length == pixels)
        });
        let Some(pixels) = pixels else { return Err("the layers differ in size".to_owned()) };
        let f = &self.functions;
        // SAFETY: no arguments but a number. A device of null is checked next.
        let device = unsafe { (f.NewDevice)(CPU) };
        if device.is_null() {
            return Err("it has no device for the CPU".to_owned());
        }
        let device = Device(f, device);
        // SAFETY: a valid device.
        unsafe { (f.CommitDevice)(device.1) };
        device.check()?;
        // SAFETY: a valid device and a C string.
        let version = unsafe { (f.GetDeviceInt)(device.1, c"version".as_ptr()) };
        // SAFETY: as above.
        let filter = unsafe { (f.NewFilter)(device.1, c"RT".as_ptr()) };
        device.check()?;
        if filter.is_null() {
            return Err("it has no filter for ray tracing".to_owned());
        }
        let filter = Filter(f, filter);
        let mut output = vec![[0.0_f32; 3]; pixels];
        for (name, image) in
            [("color", &mut color), ("albedo", &mut albedo), ("normal", &mut normal), ("output", &mut output)]
        {
            let name = CString::new(name).map_err(|error| error.to_string())?;
            // SAFETY: each image has `width · height` times three floats, without gaps (strides of 0), and lives until the
            // filter has been executed; the library does not use them afterwards.
            unsafe {
                (f.SetSharedFilterImage)(
                    filter.1,
                    name.as_ptr(),
                    image.as_mut_ptr().cast(),
                    FLOAT3,
                    width,
                    height,
                    0,
                    0,
                    0,
                );
            }
        }
        // SAFETY: a valid filter with the images that it needs, see above.
        unsafe {
            (f.SetFilterBool)(filter.1, c"hdr".as_ptr(), true);
            (f.CommitFilter)(filter.1);
            (f.ExecuteFilter)(filter.1);
        }
        device.check()?;
        drop(filter);
        Ok((output, format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100)))
    }
}
