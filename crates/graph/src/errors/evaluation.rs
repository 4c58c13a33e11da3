//! Mistakes of expressions that cannot be evaluated.

use super::language::attributes;
use crate::language::{Attribute, Name, Scalar, Value};
use crate::source::{Located, Span};

mistakes! {
    /// An expression without a value, or with one of the wrong type.
    EvaluationError:

    Type(span: Span, expected: &'static str, value: Value) =>
        Expression("{expected} is needed here, not {}", value.describe())
        .at(&span, format!("this is {value}"))
        .help_any(match value {
            Value::Scalar(Scalar::Number(number))
                if number.abs() < 1e9 && expected.contains("whole") =>
            {
                Some("`floor(…)` and `ceil(…)` make a whole number of it".to_owned())
            }
            Value::Scalar(_) if expected.contains("false") => {
                Some(format!("compare it: `{} > 0`", operand(&span)))
            }
            _ => None,
        });

    Lengths(span: Span, lengths: [usize; 2]) =>
        Expression("{} numbers do not go with {}", lengths[0], lengths[1])
        .at(span, "here").help("name parts of the longer one, as `x.width` and `x.height`");

    /// A number below 0; `least` is the least one that has a use here.
    Negative(place: Span, number: i64, least: u32) =>
        Expression("{}", match place.text() {
            text if text == number.to_string() => format!("{number} is below 0"),
            text => format!("`{text}` is {number}, below 0"),
        })
        .at(&place, "sizes, counts and indices are 0 at least")
        .help_any((place.text().parse::<i64>().is_err()).then(|| {
            format!("keep it above: `max({}, {least})`", place.text())
        }));

    Large(place: Span, number: u64) =>
        Expression("{number} is more than 32 bits hold").at(place, "here");

    DivisionByZero(place: Span) =>
        Expression("this divides by zero").at(place, "here");

    Overflow(place: Span) =>
        Expression("the result is larger than a number can be").at(place, "here");

    NoSuchWord(span: Span, word: String, words: Vec<Name>) =>
        Expression("`{word}` is not one of the words")
        .at(span, "").suggest(&word, words.iter().map(Name::as_str));

    Words(span: Span, expected: Vec<String>, value: Value) =>
        Expression("{}", match &value {
            Value::Word(_) => "not every word of this Choice may stand here".to_owned(),
            value => format!("a word is needed here, not {}", value.describe()),
        })
        .at(span, format!("this is {value}"))
        .help(format!(
            "a Choice of these words may stand here, all of its words being among them: {}",
            expected.join(", ")
        ));

    UnknownAttribute { span: Span, owner: String, name: String } =>
        Expression("`{owner}` has no attribute `{name}`")
        .at(span, "").suggest(&name, Attribute::ALL.iter().map(|(name, _)| *name));

    NoAttribute(span: Span, owner: String) =>
        Expression("{owner} has no such attribute")
        .at(span, "").help(format!("attributes are {}", attributes()));

    /// A component that a value has not: `size.z` of two numbers, or any of one.
    NoComponent { place: Span, owner: String, component: &'static str, value: Value } =>
        Expression("`{owner}` has no component `{component}`")
        .at(place, format!("`{owner}` is {value}"))
        .help(match &value {
            Value::List(list) => format!(
                "its numbers are {}",
                ["`x`", "`y`", "`z`", "`w`"][..list.len().min(4)].join(", ")
            ),
            _ => "only sizes and vectors have `x`, `y`, `z`, `w`".to_owned(),
        });

    NoCount(name: Located<String>) =>
        Size("`{name}` has no number of items")
        .at(name, "it says no `count`")
        .help("give the buffer one, and its shaders an array of any length");

    Uncounted(name: Located<String>) =>
        Size("it is not known how many items `{name}` has")
        .at(name, "its items are counted when it is built")
        .help("bind all of it, and let the shader ask for `arrayLength`");

    Circular(name: Located<String>) =>
        Size("`{name}`: its size is that of itself")
        .at(name, "").help("give one of these materials a size of its own");

    CircularValue(ring: Vec<Located<String>>) =>
        Value("`{}` is made of itself", ring.first().map_or("", |name| name.as_str()))
        .at_all(ring.iter().take(ring.len() - 1).map(|name| (name, "asks for the next")))
        .help(format!("the ring is {}", names(&ring).join(" → ")));

    DeepValue(name: Located<String>, most: usize) =>
        Value("values are made of each other more than {most} deep at `{name}`")
        .at(name, "").help("use fewer steps");

    /// `index` outside of a repetition. `entry` names the group or include whose index is asked
    /// for; `None` for the innermost one.
    NoIndex(place: Span, entry: Option<Name>) =>
        Expression("nothing is repeated here")
        .at(place, match &entry {
            None => "`index` is that of a repetition".to_owned(),
            Some(name) => format!("no repeated entry around this is called `{name}`"),
        })
        .help_any(entry.is_none().then_some("write a number, or `repeat: …`"));

    /// The number of the frame where it has no value.
    FrameNumber(place: Span) =>
        Expression("`frame.index` stands in `run: When(…)` alone, with a remainder")
        .at(place, "what is planned holds for every frame")
        .help(
            "write `run: When(\"frame.index % 4 == 0\")`; a shader reads `frame.index` of \
             `shared/frame.wgsl`",
        );

    FramePeriod { place: Span, period: u64, most: u64 } =>
        Expression("the conditions on `frame.index` repeat every {period} frames")
        .at(place, format!("{most} are the most"))
        .help("take remainders by numbers that divide each other, such as 4 and 8");

    NoSizes(place: Span, name: String) =>
        Expression("`{name}` has no size here: only params and features have values")
        .at(place, "here");

    NoShader(place: Span) =>
        Expression("no shader's constant can stand here")
        .at(place, "names in capitals are constants of a pass's shader")
        .help("use a param, which is written in small letters");

    NoConstant { span: Span, file: String, name: String, constants: Vec<String> } =>
        Expression("`{file}` has no scalar constant `{name}`")
        .at(span, "").suggest(&name, constants)
        .help("a constant that a document asks for has a type: `const NAME: u32 = …;`");

    Unknown { span: Span, what: String, word: String, names: Vec<String> } =>
        UnknownParam("{what}").at(span, "").suggest(&word, names);
}

/// The text of an expression as one side of a comparison.
fn operand(span: &Span) -> String {
    let text = span.text();
    if text.contains(['?', '|', '&', '=', '<', '>']) {
        format!("({text})")
    } else {
        text.to_owned()
    }
}

fn names(ring: &[Located<String>]) -> Vec<&str> {
    ring.iter().map(|name| name.as_str()).collect()
}

impl EvaluationError {
    /// Creates the error for the index of an entry, or of the innermost one, that is not repeated.
    pub fn no_index(place: &Span, entry: Option<&Name>) -> Self {
        match entry {
            Some(name) if name.as_str() == "frame" => Self::FrameNumber(place.clone()),
            entry => Self::NoIndex(place.clone(), entry.cloned()),
        }
    }

    /// Creates the error for the name of an expression that is not a param. `is_material` is true
    /// of a name that a material has.
    pub fn param(
        name: &str,
        span: &Span,
        is_material: impl Fn(&str) -> bool,
        names: Vec<String>,
    ) -> Self {
        if let Some((owner, attribute)) = name.rsplit_once('.')
            && (owner == "viewport" || is_material(owner))
        {
            return Self::UnknownAttribute {
                span: span.clone(),
                owner: owner.to_owned(),
                name: attribute.to_owned(),
            };
        }
        let is_material = is_material(name);
        Self::Unknown {
            span: span.clone(),
            what: if is_material {
                format!("`{name}` is a material: name an attribute of it, `{name}.size`")
            } else {
                format!("unknown param `{name}`")
            },
            word: name.to_owned(),
            names: if is_material { Vec::new() } else { names },
        }
    }
}
