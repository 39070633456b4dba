//! Device milliseconds of prefix sums, sorts and photon-map builds: medians of ten runs, with minimum and
//! maximum. `--small` for a software device; or sizes, as numbers.
#![expect(clippy::print_stdout, reason = "a program")]

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut sizes: Vec<u64> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = if arguments.iter().any(|argument| argument == "--small") {
            vec![10_000, 100_000]
        } else {
            vec![1_000_000, 10_000_000]
        };
    }
    let mut on = backend_vulkan::Vulkan::new()?;
    println!("{}, {}", on.limits().name, on.limits().driver);
    println!("{:<28} {:>10} {:>9} {:>9} {:>9}", "work", "count", "median ms", "least", "greatest");
    backend_vulkan::low_level::index_bench::run(&mut on, &sizes, &mut |row| {
        let [median, least, greatest] = row.milliseconds;
        println!("{:<28} {:>10} {median:>9.3} {least:>9.3} {greatest:>9.3}", row.work, row.count);
    })?;
    Ok(())
}
