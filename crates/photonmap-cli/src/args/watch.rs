//! The options for watching a render.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

/// Where the picture is shown while it is rendered.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Watching")]
pub struct WatchArgs {
    /// Write the picture so far to this file, .png or .exr, again and again; it is replaced atomically.
    #[arg(long, value_name = "FILE", hide_short_help = true, hide_long_help = true)]
    pub preview: Option<PathBuf>,
    /// Show the picture so far on a web page at this address; with port 0, any free port is used and printed.
    ///
    /// Without a host it is 127.0.0.1, for this machine alone. The page has the layers, the error and an exposure of its own.
    /// Anyone who can connect to the address can see it.
    #[arg(long, value_name = "[HOST:]PORT")]
    pub serve: Option<ServeAddress>,
    /// Show the picture so far and its layers in the viewer tev, which has to run there already.
    #[arg(long, value_name = "HOST[:PORT]", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:14158", hide_short_help = true, hide_long_help = true)]
    pub tev: Option<String>,
    /// Show the picture so far in the terminal, which needs to support colours of 24 bits.
    #[arg(long, hide_short_help = true)]
    pub show: bool,
}

/// Where a page is served.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ServeAddress {
    /// A name or an address, without brackets.
    pub host: String,
    /// The port; 0 for any free one.
    pub port: u16,
}

impl FromStr for ServeAddress {
    type Err = &'static str;

    /// Parses `8080`, `localhost:8080`, `192.168.0.7:8080` and `[::1]:8080`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const ASK: &str = "give a port, or a host and a port, such as 8080, localhost:8080 or [::1]:8080";
        let (host, port) = text.rsplit_once(':').unwrap_or(("127.0.0.1", text));
        let host = match host.strip_prefix('[') {
            Some(rest) => rest.strip_suffix(']').ok_or(ASK)?,
            None if host.contains(':') => return Err(ASK),
            None => host,
        };
        let port = port.parse().map_err(|_| ASK)?;
        if host.is_empty() { Err(ASK) } else { Ok(Self { host: host.to_owned(), port }) }
    }
}

impl fmt::Display for ServeAddress {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port } = self;
        if host.contains(':') { write!(to, "[{host}]:{port}") } else { write!(to, "{host}:{port}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_a_port_and_perhaps_a_host() {
        for (text, shown) in [
            ("8080", "127.0.0.1:8080"),
            ("localhost:0", "localhost:0"),
            ("192.168.0.7:80", "192.168.0.7:80"),
            ("[::1]:8080", "[::1]:8080"),
        ] {
            assert_eq!(text.parse::<ServeAddress>().unwrap().to_string(), shown);
        }
        for wrong in ["", "here", ":8080", "localhost", "::1:8080", "localhost:65536", "localhost:-1", "[::1:8080"] {
            assert!(wrong.parse::<ServeAddress>().is_err(), "{wrong}");
        }
    }
}
