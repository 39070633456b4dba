//! The settings that are tried: each knob by itself, about a middle setting.

use photon_core::{Direct, Estimator, IndexKind, Indirect, Kernel, RandomKind, Settings, Sharing};

/// One setting.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// What is turned.
    pub(crate) knob: &'static str,
    /// To what.
    pub(crate) value: String,
    pub(crate) settings: Settings,
    pub(crate) passes: u32,
}

/// Passes of the middle setting.
pub(crate) const PASSES: u32 = 16;

/// The middle setting. A scene whose truth is that of scattered light alone shows nothing else.
pub(crate) fn base(scene: &str, photons: u32) -> Settings {
    let direct = if scene == "integrating-sphere" { Direct::None } else { Direct::Nee };
    Settings { photons, direct, ..Settings::default() }
}

/// All of them; `radius` is the one that the library derives.
pub(crate) fn points(base: &Settings, radius: f64) -> Vec<Point> {
    let mut points = Vec::new();
    let mut add = |knob, value: &str, settings: Settings, passes| {
        points.push(Point { knob, value: value.to_owned(), settings, passes });
    };
    let with = |change: &dyn Fn(&mut Settings)| {
        let mut settings = base.clone();
        change(&mut settings);
        settings
    };
    for passes in [1, 4, PASSES, 4 * PASSES] {
        add("passes", &passes.to_string(), base.clone(), passes);
    }
    for factor in [1, 4] {
        // As many photons in fewer, larger passes.
        let passes = PASSES / factor;
        add("photons per pass", &format!("x{factor}"), with(&|s| s.photons *= factor), passes);
    }
    add("photons per pass", "x1/4", with(&|s| s.photons /= 4), 4 * PASSES);
    for factor in [0.5, 1.0, 2.0] {
        let radius = Some(radius * factor);
        add("radius", &format!("x{factor}"), with(&|s| s.estimator = Estimator::Radius { radius }), PASSES);
    }
    for alpha in [2.0 / 3.0, 0.8, 1.0] {
        add("alpha", &format!("{alpha:.2}"), with(&|s| s.alpha = alpha), PASSES);
    }
    let kernels = [
        ("constant", Kernel::Constant),
        ("cone", Kernel::Cone { slope: 1.0 }),
        ("epanechnikov", Kernel::Epanechnikov),
        ("biweight", Kernel::Biweight),
    ];
    for (name, kernel) in kernels {
        add("kernel", name, with(&|s| s.kernel = kernel), PASSES);
    }
    for k in [20, 50, 200] {
        let estimator = Estimator::Knn { k, max_radius: None };
        add("estimator", &format!("{k} nearest"), with(&|s| s.estimator = estimator), PASSES);
    }
    add("estimator", "paper", Settings { photons: base.photons, direct: base.direct, ..Settings::paper() }, PASSES);
    for (name, index) in [("median", IndexKind::Median), ("VVH", IndexKind::Vvh), ("Morton", IndexKind::Morton)] {
        add("index", name, with(&|s| s.index = index), PASSES);
    }
    for rays in [4, 16] {
        let change = move |s: &mut Settings| (s.indirect, s.gather_rays) = (Indirect::Gather, rays);
        add("indirect", &format!("gather, {rays} rays"), with(&change), PASSES);
    }
    add("sharing", "static", with(&|s| s.sharing = Sharing::Static), PASSES);
    add("generator", "LCG", with(&|s| s.random = RandomKind::Lcg), PASSES);
    for passes in [4, PASSES] {
        add("generator", &format!("Sobol, {passes} passes"), with(&|s| s.random = RandomKind::Sobol), passes);
    }
    add("errors", "told", with(&|s| s.errors = true), PASSES);
    add("errors", "told, passes x4", with(&|s| s.errors = true), 4 * PASSES);
    points
}
