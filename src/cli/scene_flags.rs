//! Flags for every field of `quality` and `output` and for every dial of a method: `--water-cells 512`, `--layers
//! radiance,depth`, `--method planes --planes 101`.

use std::path::PathBuf;
use std::sync::LazyLock;

use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use crate::methods;
use crate::scene::overrides::Field;

/// A scene file, and the fields to replace in it.
#[derive(Clone, Debug, Args)]
pub struct SceneArgs {
    /// Scene file (JSON); `-` reads stdin. Meshes are paths relative to the file.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Fields to replace.
    #[command(flatten)]
    pub overrides: SceneOverrides,
}

/// Fields to replace, as JSON pointer and text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneOverrides(pub Vec<(String, String)>);

/// A flag with static names, because clap keeps borrowed names only.
struct Flag {
    pointer: String,
    long: String,
    help: String,
    heading: &'static str,
    value_name: &'static str,
}

static FLAGS: LazyLock<Vec<Flag>> =
    LazyLock::new(|| methods::fields().into_iter().map(flag).collect());

fn flag(field: Field) -> Flag {
    let words = match field.words.as_slice() {
        [] => String::new(),
        words => format!(" [possible values: {}]", words.join(", ")),
    };
    let separator = if field.is_list {
        " Several values are separated by commas."
    } else {
        ""
    };
    Flag {
        long: field.flag,
        help: format!("{}{separator}{words}", field.help),
        heading: if field.pointer.starts_with("/quality") {
            "Replace fields of `quality`"
        } else {
            "Replace fields of `output`"
        },
        value_name: if field.is_list { "VALUES" } else { "VALUE" },
        pointer: field.pointer,
    }
}

impl Args for SceneOverrides {
    fn augment_args(command: Command) -> Command {
        command.args(FLAGS.iter().map(|flag| {
            Arg::new(flag.pointer.as_str())
                .long(flag.long.as_str())
                .help(flag.help.clone())
                .help_heading(flag.heading)
                .value_name(flag.value_name)
                .action(ArgAction::Set)
                // In `--exposure-ev -1` and `--min-m -1,-1`, the negative numbers are values, not flags.
                .allow_hyphen_values(true)
        }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SceneOverrides {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = FLAGS.iter().filter_map(|flag| {
            let text = matches.get_one::<String>(flag.pointer.as_str())?;
            Some((flag.pointer.clone(), text.clone()))
        });
        Ok(Self(given.collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
