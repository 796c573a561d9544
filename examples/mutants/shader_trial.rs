//! Renders hard cases with planted shaders, in this process.

use std::error::Error;

use caustica::config::RenderConfig;
use caustica::gpu::shader::ShaderSources;
use caustica::lab::hard_cases::{self, Case, Family, Settings, Truths};
use caustica::methods;
use caustica::render::Renderer;

use super::shader_plants::ShaderPlant;

/// The outcome for a plant.
pub(crate) struct Noticed {
    /// Cases that no longer hold, in the suite's order.
    pub(crate) red: Vec<&'static Case>,
    /// Cases that had to fail and did not.
    pub(crate) missing: Vec<&'static str>,
    /// Cases that failed but are not listed.
    pub(crate) unexpected: Vec<&'static str>,
}

impl Noticed {
    /// Whether exactly the listed cases failed.
    pub(crate) fn is_exact(&self) -> bool {
        self.missing.is_empty() && self.unexpected.is_empty()
    }
}

/// The cases that plants are tested with: all except those about the device, which render nothing of their own, and those that are known
/// to fail, which cannot catch anything.
pub(crate) fn tried() -> impl Iterator<Item = &'static Case> {
    hard_cases::all().filter(|case| case.family != Family::Machine && case.known_failure.is_none())
}

/// Runs hard cases, and keeps what does not depend on shaders.
#[derive(Default)]
pub(crate) struct Bench {
    truths: Truths,
    /// Whether all cases hold with the original shaders.
    is_sound: bool,
}

impl Bench {
    /// Runs the cases of all families with a plant; without it each must be as expected.
    pub(crate) fn try_plant(&mut self, plant: &ShaderPlant) -> Result<Noticed, Box<dyn Error>> {
        self.see_all_sound()?;
        let sources = planted(plant)?;
        let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources)?;
        let red: Vec<&'static Case> = tried()
            .filter(|case| !self.holds(case, &mut renderer))
            .collect();
        let is_red = |name: &str| red.iter().any(|case| case.name == name);
        let names = || tried().map(|case| case.name);
        let missing = names().filter(|name| plant.red.holds(name) && !is_red(name));
        let unexpected = names().filter(|name| !plant.red.holds(name) && is_red(name));
        let (missing, unexpected) = (missing.collect(), unexpected.collect());
        Ok(Noticed {
            red,
            missing,
            unexpected,
        })
    }

    /// Without any plant all cases hold.
    fn see_all_sound(&mut self) -> Result<(), Box<dyn Error>> {
        if self.is_sound {
            return Ok(());
        }
        let mut renderer = Renderer::new(&RenderConfig::default())?;
        let failing: Vec<&str> = tried()
            .filter(|case| !self.holds(case, &mut renderer))
            .map(|case| case.name)
            .collect();
        if !failing.is_empty() {
            return Err(format!("without any plant these fail: {}", failing.join(", ")).into());
        }
        self.is_sound = true;
        Ok(())
    }

    fn holds(&mut self, case: &'static Case, renderer: &mut Renderer) -> bool {
        let outcome = hard_cases::run_with(case, renderer, &mut self.truths, Settings::default());
        outcome.verdict.is_expected()
    }
}

/// The shaders with a plant in them.
fn planted(plant: &ShaderPlant) -> Result<ShaderSources, Box<dyn Error>> {
    let sources = methods::embedded();
    let count = sources
        .text(plant.file)
        .map_or(0, |text| text.matches(plant.from).count());
    if count != 1 {
        return Err(format!(
            "{} says `{}` {count} times; it must be once",
            plant.file, plant.from
        )
        .into());
    }
    let planted = sources.with_replacement(plant.file, plant.from, plant.to);
    planted.ok_or_else(|| format!("there is no {}", plant.file).into())
}
