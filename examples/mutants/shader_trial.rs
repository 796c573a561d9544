//! Rendering hard cases with planted shaders, in this process.

use std::collections::BTreeMap;
use std::error::Error;

use caustica::config::RenderConfig;
use caustica::gpu::shader::ShaderSources;
use caustica::hard_cases::{self, Case, Settings, Truths};
use caustica::passes::shaders;
use caustica::render::Renderer;

use super::shader_plants::ShaderPlant;

/// What came of a plant.
pub(crate) struct Noticed {
    /// Cases that no longer end as without it.
    pub(crate) red: Vec<&'static str>,
    /// Cases that had to fail and did not.
    pub(crate) missing: Vec<&'static str>,
    /// Cases of the family.
    pub(crate) of: usize,
}

/// Runs hard cases, and remembers what does not depend on shaders.
#[derive(Default)]
pub(crate) struct Bench {
    truths: Truths,
    /// How cases end with the shaders as they are.
    sound: BTreeMap<&'static str, bool>,
}

impl Bench {
    /// Runs the plant's family with it; each case must be as expected without.
    pub(crate) fn try_plant(&mut self, plant: &ShaderPlant) -> Result<Noticed, Box<dyn Error>> {
        let cases: Vec<&'static Case> = hard_cases::all()
            .filter(|case| case.family.name() == plant.family)
            // What fails anyway notices nothing.
            .filter(|case| case.known_failure.is_none())
            .collect();
        let unknown: Vec<&str> = self.untried(&cases)?;
        if !unknown.is_empty() {
            return Err(format!("without any plant these fail: {}", unknown.join(", ")).into());
        }
        let sources = planted(plant)?;
        let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources)?;
        let mut red = Vec::new();
        for case in &cases {
            if !self.holds(case, &mut renderer) {
                red.push(case.name);
            }
        }
        let is_missing = |name: &&&str| !red.contains(*name);
        let missing = plant.cases.iter().filter(is_missing).copied().collect();
        Ok(Noticed {
            red,
            missing,
            of: cases.len(),
        })
    }

    /// Those of the cases that fail with the shaders as they are.
    fn untried(&mut self, cases: &[&'static Case]) -> Result<Vec<&'static str>, Box<dyn Error>> {
        if cases.iter().any(|case| !self.sound.contains_key(case.name)) {
            let mut renderer = Renderer::new(&RenderConfig::default())?;
            for &case in cases {
                let holds = self.holds(case, &mut renderer);
                self.sound.insert(case.name, holds);
            }
        }
        let fails = |case: &&&'static Case| !self.sound[case.name];
        Ok(cases.iter().filter(fails).map(|case| case.name).collect())
    }

    fn holds(&mut self, case: &'static Case, renderer: &mut Renderer) -> bool {
        let outcome = hard_cases::run_with(case, renderer, &mut self.truths, Settings::default());
        outcome.verdict.is_expected()
    }
}

/// The shaders with a plant in them.
fn planted(plant: &ShaderPlant) -> Result<ShaderSources, Box<dyn Error>> {
    let sources = shaders::embedded();
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
