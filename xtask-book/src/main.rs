//! Renders the book in one folder to HTML in another: `xtask-book docs target/book`.

use std::path::PathBuf;
use std::process::ExitCode;

use mdbook_driver::MDBook;

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [from, to] = arguments.as_slice() else {
        eprintln!("usage: xtask-book FOLDER_WITH_BOOK_TOML OUTPUT_FOLDER");
        return ExitCode::from(2);
    };
    let built = std::path::absolute(to).map_err(Into::into).and_then(|to| {
        let mut book = MDBook::load(from)?;
        book.config.build.build_dir = to;
        book.build()
    });
    match built {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
