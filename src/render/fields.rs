//! The kept fields of light: their arena, and what a frame needs of it.

use super::{RenderError, Renderer, bindable_bytes};
use crate::cache::ArenaError;
use crate::facts::{FieldKey, SceneFacts};
use crate::plan::{self, FramePlan};
use crate::stages::light_field::{self, LIGHT_FIELD};
use crate::stats::CacheStats;

impl Renderer {
    /// Makes room for the fields that a plan uses, and returns those that must be made.
    pub(super) fn reserve_fields(
        &mut self,
        facts: &SceneFacts,
        plan: &FramePlan,
    ) -> Result<Vec<FieldKey>, RenderError> {
        if plan.graph.slot(&LIGHT_FIELD).is_none() {
            return Ok(Vec::new());
        }
        let reserved = self.fields.reserve(&plan::fields(facts));
        reserved.map_err(|error| self.fields_over_budget(error, facts))
    }

    /// Drops the fields if a plan that uses none does not fit beside them.
    pub(super) fn drop_idle_fields(&mut self, plan: &FramePlan) {
        let idle = self.idle_field_bytes(plan);
        if idle > 0 && plan.report.peak_bytes.saturating_add(idle) > self.memory_budget_bytes {
            self.fields.clear();
            self.field_arena = None;
            self.bind_groups.clear();
        }
    }

    /// Bytes of the arena of fields if it is only held for other frames than the plan's, else 0.
    pub(super) fn idle_field_bytes(&self, plan: &FramePlan) -> u64 {
        self.resident_field_bytes() - self.field_bytes_of(plan)
    }

    /// Bytes of the arena of fields.
    pub(super) fn resident_field_bytes(&self) -> u64 {
        self.field_arena.as_ref().map_or(0, wgpu::Buffer::size)
    }

    /// The same if the plan uses fields, else 0: then the arena is only held for other frames.
    pub(super) fn field_bytes_of(&self, plan: &FramePlan) -> u64 {
        match plan.graph.slot(&LIGHT_FIELD) {
            Some(_) => self.resident_field_bytes(),
            None => 0,
        }
    }

    fn fields_over_budget(&self, error: ArenaError, facts: &SceneFacts) -> RenderError {
        let limit = if error.budget_bytes < bindable_bytes(&self.gpu) {
            "CAUSTICA_FIELD_BUDGET_MIB"
        } else {
            "the device's limit for one binding"
        };
        let resolution = facts.field.as_ref().map(light_field::in_words);
        RenderError::OverBudget {
            what: format!(
                "holding the fields of {} beam sets at once, each of {} ({limit})",
                facts.lights.beam_sets.len(),
                resolution.unwrap_or_default()
            ),
            needed_bytes: error.needed_bytes,
            budget_bytes: error.budget_bytes,
        }
    }

    /// Statistics of the kept fields of light: hits, misses and evictions since the start; entries and bytes now.
    pub fn field_cache(&self) -> CacheStats {
        self.fields.stats()
    }
}
