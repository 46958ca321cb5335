//! Arguments that several subcommands share.

use clap::Args;
use etalon::camera::Sensor;
use etalon::error::Error;
use etalon::integrator::{Budget, Integrator};
use etalon::path::{Groups, Strategies};
use etalon::pilot::Selection;
use etalon::scene::{Leaving, Plan, Scene, View};
use std::time::Duration;

/// How much to render, and with what.
#[derive(Clone, Debug, Args)]
pub struct Effort {
    /// Samples per pixel; at most so many, with --error
    #[arg(long, value_name = "N", conflicts_with = "time", value_parser = clap::value_parser!(u64).range(1..=1 << 32))]
    pub spp: Option<u64>,
    /// Render until the picture's relative error is about this, as 0.01 or 1%, unbiased
    #[arg(long, value_name = "E", value_parser = error)]
    pub error: Option<f64>,
    /// Render for about this many seconds, unbiased
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time: Option<Duration>,
    /// Seed of the random numbers; the same seed gives the same bits on any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads; all processors if left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Size of the picture instead of the scene's, as WIDTHxHEIGHT
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub resolution: Option<[u32; 2]>,
    /// Algorithm: path, light, bdpt, mlt, or auto, which tries them on a small share of the work and
    /// takes the best [default: auto, or the reference case's own]
    #[arg(long, value_name = "NAME", value_parser = algorithm)]
    pub integrator: Option<Algorithm>,
    /// Groups of strategies that bdpt uses, of path, joins and splats, as path,splats [default: all]
    #[arg(long, value_name = "LIST", value_parser = groups)]
    pub groups: Option<Groups>,
    /// Cut paths off after this many bounces and say what that loses [default: no limit]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=MOST_BOUNCES))]
    pub max_bounces: Option<u32>,
    /// What the render leaves out: lean (all that the scene does not need), full (nothing), or
    /// keep=NAME,... (all but these); the expected picture is the same
    #[arg(long = "plan", value_name = "WHAT", default_value_t = Leaving::all(), value_parser = leaving)]
    pub leaving: Leaving,
}

/// An algorithm as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Algorithm {
    /// The best of all, found out by a pilot.
    Auto,
    /// This one.
    Named(Integrator),
}

/// The name of [`Algorithm::Auto`].
const AUTO: &str = "auto";

impl Algorithm {
    const fn name(self) -> &'static str {
        match self {
            Self::Auto => AUTO,
            Self::Named(integrator) => integrator.name(),
        }
    }
}

/// Bounces beyond which a limit is none.
const MOST_BOUNCES: i64 = 1 << 30;

impl Effort {
    /// When to stop; `default_spp` where neither samples nor error nor time are given.
    pub fn budget(&self, default_spp: u64) -> Budget {
        let is_open = self.time.is_some() || self.error.is_some();
        let samples_per_pixel = self.spp.unwrap_or(if is_open { u64::MAX } else { default_spp });
        Budget { samples_per_pixel, time: self.time, error: self.error, seed: self.seed }
    }

    /// The algorithm and the groups that are asked for; `None` where they are to be found out.
    ///
    /// # Errors
    /// Where groups are given that the algorithm does not have.
    pub fn selection(&self) -> etalon::error::Result<Option<Selection>> {
        match (self.integrator, self.groups) {
            (Some(Algorithm::Named(Integrator::Bdpt)), groups) => {
                Ok(Some(Selection { integrator: Integrator::Bdpt, groups }))
            }
            (_, Some(groups)) => {
                Err(Error::new(format!("--groups {groups} are groups of strategies of bdpt"))
                    .hint("add --integrator bdpt, or leave --groups out"))
            }
            (Some(Algorithm::Named(integrator)), None) => Ok(Some(Selection::whole(integrator))),
            (None | Some(Algorithm::Auto), None) => Ok(None),
        }
    }

    /// The same effort with what was selected.
    #[must_use]
    pub fn with(&self, selection: Selection) -> Self {
        let integrator = Some(Algorithm::Named(selection.integrator));
        Self { integrator, groups: selection.groups, ..self.clone() }
    }

    /// The algorithm, once it is settled.
    pub fn integrator(&self) -> Integrator {
        match self.integrator {
            Some(Algorithm::Named(integrator)) => integrator,
            None | Some(Algorithm::Auto) => Integrator::Path,
        }
    }

    /// Algorithm and groups, once they are settled.
    pub fn selected(&self) -> Selection {
        Selection { integrator: self.integrator(), groups: self.groups }
    }

    /// Its strategies.
    pub fn strategies(&self) -> Strategies {
        self.selected().strategies()
    }

    /// What a scene needs for this effort as a sensor sees it.
    pub fn plan(&self, scene: &Scene, sensor: &Sensor) -> Plan {
        let plan = Plan::under(scene, sensor, self.strategies(), &self.leaving);
        Plan { most_bounces: self.max_bounces, ..plan }
    }

    /// The same effort as words of a command line.
    pub fn words(&self) -> Vec<String> {
        let Self { spp, error, time, seed, threads, resolution, integrator, groups, max_bounces, leaving } =
            self;
        let given = [
            ("--spp", spp.map(|spp| spp.to_string())),
            ("--error", error.map(|error| error.to_string())),
            ("--time", time.map(|time| time.as_secs_f64().to_string())),
            ("--seed", Some(seed.to_string())),
            ("--threads", threads.map(|threads| threads.to_string())),
            ("--resolution", resolution.map(|[width, height]| format!("{width}x{height}"))),
            ("--integrator", integrator.map(|integrator| integrator.name().to_owned())),
            ("--groups", groups.map(|groups| groups.to_string())),
            ("--max-bounces", max_bounces.map(|bounces| bounces.to_string())),
            ("--plan", (*leaving != Leaving::all()).then(|| leaving.to_string())),
        ];
        let pair = |(option, value): (&str, Option<String>)| value.map(|value| [option.to_owned(), value]);
        given.into_iter().filter_map(pair).flatten().collect()
    }

    /// Sets the number of threads for the whole process.
    pub fn start_threads(&self) -> anyhow::Result<()> {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(self.threads.map_or(0, usize::from));
        Ok(builder.build_global()?)
    }

    /// The view at the size that is asked for.
    pub fn resize(&self, view: &View) -> View {
        let mut view = view.clone();
        if let Some(resolution) = self.resolution {
            view.camera = view.camera.with_resolution(resolution);
        }
        view
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let value: f64 = text.parse().map_err(|_| "give a number of seconds, such as 60".to_owned())?;
    let time = Duration::try_from_secs_f64(value).ok().filter(|time| !time.is_zero());
    time.ok_or_else(|| "give a positive number of seconds, such as 60".to_owned())
}

/// A relative error, as a share of one or in per cent.
pub fn error(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
    let share = number.trim_end().parse::<f64>().map(|value| value / unit).ok();
    let share = share.filter(|share| *share > 0.0 && *share < 1.0);
    share.ok_or_else(|| "give a share between 0 and 1, such as 0.01 or 1%".to_owned())
}

pub fn resolution(text: &str) -> Result<[u32; 2], String> {
    let explain = || "give width and height as in 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(explain)?;
    let side = |part: &str| part.parse::<u32>().ok().filter(|side| (1..=1 << 14).contains(side));
    Ok([side(width).ok_or_else(explain)?, side(height).ok_or_else(explain)?])
}

/// What a plan leaves out.
pub fn leaving(text: &str) -> Result<Leaving, String> {
    text.parse().map_err(|error: Error| error.to_string())
}

pub fn integrator(name: &str) -> Result<Integrator, String> {
    let known = || Integrator::ALL.iter().map(|i| i.name());
    Integrator::named(name).ok_or_else(|| Error::unknown_name("integrator", name, known()).to_string())
}

fn algorithm(name: &str) -> Result<Algorithm, String> {
    let known = || Integrator::ALL.iter().map(|i| i.name()).chain([AUTO]);
    let named = || Integrator::named(name).map(Algorithm::Named);
    let found = if name == AUTO { Some(Algorithm::Auto) } else { named() };
    found.ok_or_else(|| Error::unknown_name("integrator", name, known()).to_string())
}

pub fn groups(names: &str) -> Result<Groups, String> {
    Groups::named(names).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Alone {
        #[command(flatten)]
        effort: Effort,
    }

    #[test]
    fn an_error_is_a_share_or_per_cent() {
        assert_eq!([error("1%"), error("0.01"), error("2.5 %")], [Ok(0.01), Ok(0.01), Ok(0.025)]);
        for wrong in ["0", "-1%", "100%", "1", "nan", "%", "1 percent"] {
            assert!(error(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn words_say_the_same_effort_again() {
        for line in [
            "--spp 3 --seed 7 --threads 2 --resolution 640x480 --integrator bdpt",
            "--spp 3 --seed 7 --integrator bdpt --groups path,splats",
            "--seed 0 --integrator auto",
            "--time 0.5 --seed 0",
            "--spp 1000 --error 0.01 --seed 0",
            "--error 0.003 --time 60 --seed 0",
            "--seed 0 --max-bounces 100",
            "--seed 0 --plan full",
            "--seed 0 --plan keep=media,lens",
            "--seed 18446744073709551615",
        ] {
            let words = std::iter::once("etalon").chain(line.split(' '));
            assert_eq!(Alone::parse_from(words).effort.words().join(" "), line);
        }
    }
}
