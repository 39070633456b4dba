//! Headers of PLY files.

/// Order of the bytes of numbers, or text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "int64" => Self::I64,
            "uint64" => Self::U64,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The largest integer; `None` for floats.
    pub(super) fn most(self) -> Option<f64> {
        Some(match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::I32 => i32::MAX.into(),
            Self::U32 => u32::MAX.into(),
            Self::I64 => i64::MAX as f64,
            Self::U64 => u64::MAX as f64,
            Self::F32 | Self::F64 => return None,
        })
    }
}

/// A number, or a list of them, of each element.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// Type of the length of a list.
    pub(super) length: Option<Kind>,
    pub(super) kind: Kind,
}

/// Vertices, faces or others.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Bytes that one takes at least.
    pub(super) fn least(&self, encoding: Encoding) -> u64 {
        let of = |property: &Property| match encoding {
            // A digit and a space.
            Encoding::Text => 2,
            _ => property.length.unwrap_or(property.kind).bytes() as u64,
        };
        self.properties.iter().map(of).sum()
    }
}

/// Bytes of the longest line.
const LONGEST: usize = 1 << 16;

/// Contents of a header.
#[derive(PartialEq, Eq, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Images, by `comment TextureFile`.
    pub(super) textures: Vec<String>,
    /// Its length in bytes.
    pub(super) length: usize,
}

/// Text of an error, and the number of its line.
pub(super) type Fault = (String, u64);

impl Header {
    /// Parses it; lines end as the first one does.
    ///
    /// # Errors
    /// The line at fault, and what is wrong.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        let ends = |&byte: &u8| matches!(byte, b'\n' | b'\r');
        let first = bytes.iter().position(ends).unwrap_or(bytes.len());
        let end: &[u8] =
            if bytes[first..].starts_with(b"\r\n") { b"\r\n" } else { &bytes[first..bytes.len().min(first + 1)] };
        let mut header = Self { encoding: Encoding::Text, elements: Vec::new(), textures: Vec::new(), length: 0 };
        let mut encoding = None;
        for line in 1.. {
            let rest = &bytes[header.length..];
            let length = match end.last().and_then(|last| rest.iter().position(|byte| byte == last)) {
                Some(last) => last + 1,
                // The last line of a file without elements may have no end.
                None if !rest.is_empty() => rest.len(),
                None => return Err(("the file ends in its header".to_owned(), line)),
            };
            if length > LONGEST {
                return Err(("a line of its header is too long".to_owned(), line));
            }
            header.length += length;
            let text = String::from_utf8_lossy(&rest[..length]);
            let (keyword, arguments) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
            let arguments = arguments.trim();
            let wrong = |what: &str| Err((format!("'{}': {what}", text.trim()), line));
            match (line, keyword) {
                (1, "ply") => {}
                (1, _) => return wrong("a PLY file begins with 'ply'"),
                (_, "format") => {
                    encoding = match arguments.split_whitespace().next() {
                        Some("ascii") => Some(Encoding::Text),
                        Some("binary_little_endian") => Some(Encoding::LittleEndian),
                        Some("binary_big_endian") => Some(Encoding::BigEndian),
                        _ => return wrong("a format is ascii, binary_little_endian or binary_big_endian"),
                    };
                }
                (_, "comment") => {
                    if let Some((word, name)) = arguments.split_once(char::is_whitespace)
                        && word.eq_ignore_ascii_case("TextureFile")
                    {
                        header.textures.push(name.trim().to_owned());
                    }
                }
                (_, "element") => {
                    let Some((name, count)) = arguments.rsplit_once(char::is_whitespace) else {
                        return wrong("a name and a count must follow");
                    };
                    let Ok(count) = count.parse() else { return wrong("a whole number must follow the name") };
                    if header.elements.iter().any(|known| known.name == name.trim()) {
                        return wrong("it is declared twice");
                    }
                    header.elements.push(Element { name: name.trim().to_owned(), count, properties: Vec::new() });
                }
                (_, "property") => {
                    let words: Vec<&str> = arguments.split_whitespace().collect();
                    let (length, kind, name) = match words[..] {
                        ["list", length, kind, name] => (Some(length), kind, name),
                        [kind, name] => (None, kind, name),
                        _ => return wrong("a type and a name must follow, or list, two types and a name"),
                    };
                    let Some(kind) = Kind::of(kind) else { return wrong(&format!("there is no type {kind}")) };
                    let length = match length.map(|length| Kind::of(length).filter(|kind| kind.most().is_some())) {
                        None => None,
                        Some(None) => return wrong("the length of a list must have the type of an integer"),
                        Some(length) => length,
                    };
                    let Some(element) = header.elements.last_mut() else {
                        return wrong("an element must come before it");
                    };
                    element.properties.push(Property { name: name.to_owned(), length, kind });
                }
                (_, "end_header") => break,
                (_, "obj_info" | "") => {}
                _ => return wrong("no keyword of a header"),
            }
        }
        match encoding {
            Some(encoding) => Ok(Self { encoding, ..header }),
            None => Err(("its header has no format".to_owned(), 1)),
        }
    }
}
