//! Reads the params that a document declares.

use crate::diagnostics::Diagnostic;
use crate::errors::document::DocumentError;
use crate::fields::prose;
use crate::language::{Expr, ExprKind, Name, Value};
use crate::param::{Param, ParamType, ParamValue};
use crate::source::Located;
use serde::Deserialize;
use skiagraph_located_ron::{fields::from_fields, reader::Field};
use std::collections::{BTreeMap, HashSet};

/// A param: a value from outside.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct ParamFields {
    /// As in `params.NAME` of a shader and `--set NAME=…`.
    name: Located<Name>,
    /// The words of a `Choice`.
    #[serde(default)]
    words: Vec<Located<Name>>,
    /// Value where nothing else is asked for. It may name the params above it and the viewport.
    /// Without it, a value must be given.
    default: Option<Expr>,
    /// Least value of a number, or of each component of a vector.
    min: Option<f64>,
    /// Greatest value of a number, or of each component of a vector.
    max: Option<f64>,
    /// Values that `compare --tune` tries, two at least: words of a `Choice`, booleans or numbers.
    #[serde(default)]
    tune: Vec<Expr>,
    /// True if the param decides how soft shadows look: `compare --tune` then tries the values of
    /// `tune` only under lights with an extent, whose shadows have a right softness.
    #[serde(default)]
    look: bool,
    /// Description of its effect, for those who set it.
    #[serde(default, deserialize_with = "prose")]
    description: String,
}

/// Reads the entry of a param: its type, and its fields.
pub(super) fn read(tag: &Located<String>, fields: &[Field]) -> Result<Param, Diagnostic> {
    let fields: ParamFields = from_fields(fields, &tag.span)?;
    let wrong = |why: &str| DocumentError::Param(fields.name.clone(), why.to_owned());
    let ty = match tag.as_str() {
        "F32" => ParamType::F32,
        "I32" => ParamType::I32,
        "U32" => ParamType::U32,
        "Bool" => ParamType::Bool,
        "Vec2" => ParamType::Vec2,
        "Vec3" => ParamType::Vec3,
        "Vec4" => ParamType::Vec4,
        "Choice" => ParamType::Choice(fields.words.iter().map(|w| w.value.clone()).collect()),
        _ => return Err(DocumentError::UnknownParamType(tag.clone()).into()),
    };
    let mut different = HashSet::new();
    let mut words = fields.words.iter();
    let repeats = !words.all(|word| different.insert(&word.value));
    let is_choice = matches!(ty, ParamType::Choice(_));
    if is_choice == fields.words.is_empty() || repeats {
        let why = if is_choice {
            "a Choice has `words`, one at least, and each only once"
        } else {
            "only a Choice has `words`"
        };
        return Err(wrong(why).into());
    }
    if let (Some(min), Some(max)) = (fields.min, fields.max)
        && min.partial_cmp(&max).is_none_or(std::cmp::Ordering::is_gt)
    {
        return Err(wrong(&format!("no value can lie in {min}..{max}")).into());
    }
    if *fields.name.value == *"index" {
        let why = "`index` is that of a repetition, and no param";
        return Err(wrong(why).into());
    }
    let mut param = Param {
        name: fields.name.text(),
        ty,
        default: fields.default,
        min: fields.min,
        max: fields.max,
        description: fields.description,
        refused: BTreeMap::new(),
        tune: Vec::new(),
        is_look: fields.look,
    };
    param.tune = tuned(&param, &fields.tune)?;
    Ok(param)
}

/// The values of `tune`: all different, each a value of the param.
fn tuned(param: &Param, written: &[Expr]) -> Result<Vec<ParamValue>, Diagnostic> {
    let mut values: Vec<ParamValue> = Vec::new();
    let mistake = |expr: &Expr, why: String| {
        let name = param.name.value.clone();
        DocumentError::Tune(name, expr.span.clone(), why)
    };
    for expr in written {
        let value = constant(expr).ok_or_else(|| {
            let why = "write a number, `true`, `false` or a word without quotes";
            mistake(expr, why.to_owned())
        })?;
        let value = param.convert(&value);
        let value = value.map_err(|why| mistake(expr, why.to_string()))?;
        if values.contains(&value) {
            return Err(mistake(expr, "this value is listed twice".to_owned()).into());
        }
        values.push(value);
    }
    match written {
        [one] => Err(mistake(one, "list two values at least".to_owned()).into()),
        _ => Ok(values),
    }
}

/// The value of an expression that asks for nothing; `None` for any other.
fn constant(expr: &Expr) -> Option<Value> {
    let scalar = |expr: &Expr| match constant(expr) {
        Some(Value::Scalar(scalar)) => Some(scalar),
        _ => None,
    };
    Some(match &expr.kind {
        ExprKind::Literal(value) => value.clone(),
        ExprKind::Word(word) => Value::word(word),
        ExprKind::Tuple(list) => Value::List(list.iter().map(scalar).collect::<Option<_>>()?),
        _ => return None,
    })
}
