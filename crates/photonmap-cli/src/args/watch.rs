//! The options for watching a render.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;

/// Where the picture is shown while it is rendered.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Watching")]
pub struct WatchArgs {
    /// Write the picture so far to this file, .png or .exr, again and again; it is replaced atomically.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    pub preview: Option<PathBuf>,
    /// Show the picture so far on a web page at this address; with port 0, any free port is used and printed.
    ///
    /// The page has the layers, the error and an exposure of its own. Anyone who can connect to the address can see it.
    #[arg(long, value_name = "IP:PORT", hide_short_help = true)]
    pub serve: Option<SocketAddr>,
    /// Show the picture so far and its layers in the viewer tev, which has to run there already.
    #[arg(long, value_name = "HOST[:PORT]", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:14158", hide_short_help = true)]
    pub tev: Option<String>,
    /// Show the picture so far in the terminal, which needs to support colours of 24 bits.
    #[arg(long, hide_short_help = true)]
    pub show: bool,
}
