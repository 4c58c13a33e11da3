//! Mistakes in the order of passes.

use super::link::read_previous;
use crate::resource::name_within;
use crate::source::{Located, Span};

mistakes! {
    /// A mistake in the order of passes: a read before the write, a cycle, or different run
    /// conditions.
    OrderError:

    Capture {
        name: String,
        first: Option<String>,
        /// True if a pass above has written a part of it.
        partly: bool,
    } =>
        Output("`{name}` cannot be read back: {}", written(partly))
        .help(match (first, partly) {
            (Some(first), true) => {
                format!("name a mip or layer that is written by then; `{first}` writes others")
            }
            (None, true) => "name a mip or layer that is written by then".to_owned(),
            (Some(first), false) => format!("it is first written by `{first}`"),
            (None, false) => "no pass writes it".to_owned(),
        });

    Unwritten {
        name: String,
        pass: Located<String>,
        read: Span,
        /// If the pass writes the material, too: a reference to what it reads, and the entry that
        /// clears it. `None` if it only reads.
        clear: Option<[String; 2]>,
        /// True if a pass above has written a part of the material.
        partly: bool,
    } =>
        ReadBeforeWrite(
            "pass `{pass}` {} `{name}` that no pass has written",
            verb(clear.is_some(), partly)
        )
        .at(read, "read here").at(pass, "by this pass")
        .help(match clear {
            Some([target, clear]) => format!(
                "put `{clear}` above it, if it starts anew in each frame; if it goes on from the \
                 frame before, give `{name}` `keep: true`, or bind \
                 `\"{target}.previous\"` and read that; say `overwrites: [\"{target}\"]`, if the \
                 pass itself writes all that it reads"
            ),
            None => "let a pass write it, or name another material".to_owned(),
        });

    /// A pass that writes nothing that anything else in its document names.
    Unneeded { pass: Located<String>, written: Vec<String> } =>
        Unused("nothing needs the pass `{pass}`")
        .at(pass, match &written[..] {
            [] => "it writes nothing".to_owned(),
            written => format!("nothing else names `{}`", written.join("`, `")),
        })
        .help(
            "name what it writes among the `outputs`, let a pass that is needed read it, or take \
             the pass out",
        );

    Cycle {
        /// The passes, each with what makes it come behind the one before; the first comes behind
        /// the last.
        ring: Vec<(Located<String>, String)>,
        /// Material that the first pass reads.
        previous: String,
        /// Two passes that keep the order of the file, and the material for which they do.
        moves: Option<[String; 3]>,
    } =>
        Cycle("passes need each other's results: {}", {
            let passes = ring.iter().chain(ring.first());
            let passes: Vec<&str> = passes.map(|(pass, _)| pass.value.as_str()).collect();
            passes.join(" → ")
        })
        .at_all(ring)
        .help(format!(
            "break the cycle: write a second material, or read what the frame before left, \
             `\"{previous}.previous\"`"
        ))
        .help_any(moves.map(|[below, above, name]| format!(
            "or move `{below}` above `{above}`: where several passes write one part of `{name}`, \
             all that use it run in the order of the file"
        )));

    WrittenBelow {
        name: String,
        pass: Located<String>,
        read: Span,
        writers: Vec<Located<String>>,
    } =>
        ReadBeforeWrite(
            "pass `{pass}` reads `{name}` above all that write it: {}",
            listed(&writers)
        )
        .at(&read, "read here").at(&pass, "by this pass")
        .at_all(writers.iter().map(|writer| (writer, "written here, below")))
        .help(format!(
            "move `{pass}` below the pass whose content it needs: where several passes write one \
             part of `{name}`, the order of the file decides which content is read"
        ))
        .help(read_previous(name_within(&pass, &name), &read));

    NeverWritten(name: String, pass: Located<String>, read: Span) =>
        ReadBeforeWrite("pass `{pass}` reads `{name}` of the frame before, but no pass writes it")
        .at(read, "read here").at(pass, "by this pass")
        .help(format!("let a pass write `{name}`"));

    NeverCounted { name: Located<String>, counter: String } =>
        ReadBeforeWrite("`{name}` grows by `{counter}`, which no pass writes")
        .at(name, "")
        .help(format!("let a pass count in `{counter}` the items that are needed"));

    RunConditions { name: String, passes: [Located<String>; 2], runs: [String; 2] } =>
        RunCondition(
            "passes `{}` and `{}` must run or be skipped together, for the sake of `{name}`",
            passes[0], passes[1]
        )
        .at(&passes[1], format!("`run: {}`", runs[1])).at(&passes[0], format!("`run: {}`", runs[0]))
        .help(format!(
            "both write it, or one reads what the other overwrites: give both the same `run`, or \
             one of them another material than `{name}`"
        ));
}

fn verb(changes: bool, partly: bool) -> &'static str {
    match (changes, partly) {
        (true, true) => "reads and changes a part of",
        (true, false) => "reads and changes",
        (false, true) => "reads a part of",
        (false, false) => "reads",
    }
}

/// Joins the names of passes for a sentence.
fn listed(passes: &[Located<String>]) -> String {
    let names: Vec<String> = passes.iter().map(|pass| format!("`{pass}`")).collect();
    match &names[..] {
        [first, second, _, _, ..] => format!("{first}, {second} and {} more", names.len() - 2),
        _ => names.join(" and "),
    }
}

/// How far something is written.
fn written(partly: bool) -> &'static str {
    if partly {
        "something has written some of it, but not all"
    } else {
        "nothing has written it yet"
    }
}
