//! Collects the findings while a scene is checked.

use super::error::{Issue, IssueKind};
use super::json::MAX_ISSUES;
use super::ranges::{Integer, Range, number};

/// Findings so far. After the first [`MAX_ISSUES`], further ones are only counted.
#[derive(Debug, Default)]
pub(super) struct Findings {
    issues: Vec<Issue>,
    unlisted: usize,
}

impl Findings {
    /// All listed findings; a last one states the number of those not listed.
    pub(super) fn into_issues(mut self) -> Vec<Issue> {
        if self.unlisted > 0 {
            let detail = format!("{} more findings are not listed", self.unlisted);
            self.issues.push(Issue::invalid("", detail, ""));
        }
        self.issues
    }

    fn push(&mut self, issue: Issue) {
        if self.issues.len() < MAX_ISSUES {
            self.issues.push(issue);
        } else {
            self.unlisted += 1;
        }
    }

    /// A value that is never accepted.
    pub(super) fn invalid(
        &mut self,
        pointer: impl Into<String>,
        detail: impl Into<String>,
        accepted: impl Into<String>,
    ) {
        self.push(Issue::invalid(pointer, detail, accepted));
    }

    /// A value above a limit of this installation.
    pub(super) fn over_limit(
        &mut self,
        pointer: impl Into<String>,
        detail: impl Into<String>,
        accepted: impl Into<String>,
    ) {
        let issue = Issue::invalid(pointer, detail, accepted);
        self.push(issue.of_kind(IssueKind::LimitExceeded));
    }

    /// Whether a list is short enough to be checked item by item.
    pub(super) fn count(&mut self, pointer: &str, what: &str, count: usize, limit: usize) -> bool {
        if count > limit {
            self.over_limit(
                pointer,
                format!("there are {count} {what}"),
                format!("at most {limit}"),
            );
        }
        count <= limit
    }

    /// Whether a number is inside its range.
    pub(super) fn number(&mut self, pointer: impl Into<String>, value: f64, range: &Range) -> bool {
        let inside = range.contains(value);
        if !inside {
            self.invalid(
                pointer,
                format!("{} is out of range", number(value)),
                range.to_string(),
            );
        }
        inside
    }

    /// Whether all numbers of an array are inside their range.
    pub(super) fn numbers(&mut self, pointer: &str, values: &[f64], range: &Range) -> bool {
        let mut all_inside = true;
        for (index, value) in values.iter().enumerate() {
            all_inside &= self.number(format!("{pointer}/{index}"), *value, range);
        }
        all_inside
    }

    /// Whether an integer is inside its range.
    pub(super) fn integer<I: Integer>(&mut self, pointer: &str, value: u32) -> bool {
        let inside = I::accepts(value);
        if !inside {
            self.invalid(pointer, format!("{value} is out of range"), I::accepted());
        }
        inside
    }
}
