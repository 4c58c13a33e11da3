//! Blending of what is drawn with what is there: a word, or factors and an operation.

use super::kind::Lowering;
use crate::{errors::document::DocumentError, fields::by_text, language::Expr, source::Located};
use serde::Deserialize;
use skiagraph_located_ron::reader::read;
use wgt::{BlendComponent, BlendFactor, BlendOperation, BlendState};

/// How what is drawn is mixed with what is there: a word, or `(source: …, target: …, …)`.
#[derive(Clone, Debug)]
pub(super) enum Blend {
    Word(BlendWord),
    Factors(Located<BlendFields>),
}

by_text!(Blend, |text, _| if text.starts_with('(') {
    read(text).map(Self::Factors)
} else {
    read(text).map(Self::Word)
});

/// How what is drawn is mixed with what is there.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BlendWord"))]
#[serde(rename = "blend")]
pub(super) enum BlendWord {
    Alpha,
    Premultiplied,
    Additive,
    Min,
    Max,
}

/// Factors of what is drawn and of what is there, and how the products are put together.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BlendFactors"))]
#[serde(rename = "blend", deny_unknown_fields)]
pub(super) struct BlendFields {
    /// Factor of what is drawn; `One` without it.
    #[serde(default = "one", deserialize_with = "Factor::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Factor"))]
    source: BlendFactor,
    /// Factor of what is there; `One` without it.
    #[serde(default = "one", deserialize_with = "Factor::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Factor"))]
    target: BlendFactor,
    /// How the products are put together; `Add` without it.
    #[serde(default, deserialize_with = "Operation::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Operation"))]
    operation: BlendOperation,
    /// The same of alpha; as for the colours without it.
    alpha: Option<BlendAlpha>,
    /// Value of the factor `Constant`: one number, or four.
    constant: Option<Expr>,
}

/// Blending of alpha, where it is another than that of the colours.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BlendAlpha"))]
#[serde(rename = "alpha", deny_unknown_fields)]
struct BlendAlpha {
    /// Factor of what is drawn; `One` without it.
    #[serde(default = "one", deserialize_with = "Factor::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Factor"))]
    source: BlendFactor,
    /// Factor of what is there; `One` without it.
    #[serde(default = "one", deserialize_with = "Factor::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Factor"))]
    target: BlendFactor,
    /// How the products are put together; `Add` without it.
    #[serde(default, deserialize_with = "Operation::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Operation"))]
    operation: BlendOperation,
}

fn one() -> BlendFactor {
    BlendFactor::One
}

/// Factor of blending; wgpu's names.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BlendFactor"))]
#[serde(remote = "wgt::BlendFactor")]
enum Factor {
    Zero,
    One,
    Src,
    OneMinusSrc,
    SrcAlpha,
    OneMinusSrcAlpha,
    Dst,
    OneMinusDst,
    DstAlpha,
    OneMinusDstAlpha,
    SrcAlphaSaturated,
    Constant,
    OneMinusConstant,
}

/// Operation of blending; wgpu's names.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BlendOperation"))]
#[serde(remote = "wgt::BlendOperation")]
enum Operation {
    Add,
    Subtract,
    ReverseSubtract,
    Min,
    Max,
}

impl Blend {
    /// Returns the state of the pipeline.
    pub fn state(&self, pass: &mut Lowering<'_>) -> BlendState {
        let same = |operation| {
            let color = component([BlendFactor::One; 2], operation);
            BlendState {
                color,
                alpha: color,
            }
        };
        match self {
            Self::Word(BlendWord::Alpha) => BlendState::ALPHA_BLENDING,
            Self::Word(BlendWord::Premultiplied) => BlendState::PREMULTIPLIED_ALPHA_BLENDING,
            Self::Word(BlendWord::Additive) => same(BlendOperation::Add),
            Self::Word(BlendWord::Min) => same(BlendOperation::Min),
            Self::Word(BlendWord::Max) => same(BlendOperation::Max),
            Self::Factors(fields) => checked(fields, pass),
        }
    }

    /// Returns the blend constant, with its place; `None` if none is given.
    pub fn constant(&self, pass: &mut Lowering<'_>) -> Option<Located<[f64; 4]>> {
        let Self::Factors(fields) = self else {
            return None;
        };
        let constant = fields.constant.as_ref()?;
        let list: Vec<f64> = pass.list(constant).iter().map(|it| it.number()).collect();
        let value = match list.as_slice() {
            // A document that is being loaded has no values.
            [] => [0.0; 4],
            [one] => [*one; 4],
            [r, g, b, a] => [*r, *g, *b, *a],
            _ => {
                let what = "a blend constant is one number, or four";
                pass.report(DocumentError::BlendConstant(constant.span.clone(), what));
                return None;
            }
        };
        Some(Located::new(value, constant.span.clone()))
    }
}

impl BlendFields {
    fn components(&self) -> [BlendComponent; 2] {
        let color = component([self.source, self.target], self.operation);
        let alpha = self.alpha.as_ref();
        let alpha = alpha.map(|alpha| component([alpha.source, alpha.target], alpha.operation));
        [color, alpha.unwrap_or(color)]
    }
}

/// Returns the state of factors, and reports those that wgpu refuses.
fn checked(fields: &Located<BlendFields>, pass: &mut Lowering<'_>) -> BlendState {
    let [color, alpha] = fields.components();
    let factors = |part: BlendComponent| [part.src_factor, part.dst_factor];
    let is_extreme =
        |part: &BlendComponent| matches!(part.operation, BlendOperation::Min | BlendOperation::Max);
    let mut extremes = [color, alpha].into_iter().filter(is_extreme);
    if extremes.any(|part| factors(part) != [BlendFactor::One; 2]) {
        pass.report(DocumentError::BlendFactors(fields.span.clone()));
    }
    let mut used = [color, alpha].into_iter().flat_map(factors);
    let constants = [BlendFactor::Constant, BlendFactor::OneMinusConstant];
    if fields.constant.is_none() && used.any(|factor| constants.contains(&factor)) {
        let what = "the factor `Constant` has no value";
        pass.report(DocumentError::BlendConstant(fields.span.clone(), what));
    }
    BlendState { color, alpha }
}

/// Returns the blending by the factors of what is drawn and of what is there.
fn component(factors: [BlendFactor; 2], operation: BlendOperation) -> BlendComponent {
    let [src_factor, dst_factor] = factors;
    BlendComponent {
        src_factor,
        dst_factor,
        operation,
    }
}

#[cfg(feature = "schema")]
crate::written::written!(Blend, "Blend", generator => {
    let words = generator.subschema_for::<BlendWord>();
    let factors = generator.subschema_for::<BlendFields>();
    schemars::json_schema!({ "anyOf": [words, factors] })
});
