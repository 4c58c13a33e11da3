//! Params on their way into shaders: the `params` uniform and overridable constants.

use super::Linker;
use crate::{
    diagnostics::{Code, Diagnostic},
    document::params::{ParamType, ParamValue},
    step::Program,
    wgsl::{Global, Member, ScalarClass, Shader},
};

impl Linker<'_, '_> {
    /// Values of overridable constants: what the pass kind sets, else `index` of a repeat, else the param of that name.
    pub(super) fn constants(&mut self, program: &Program, shader: &Shader) -> Vec<(String, f64)> {
        let mut constants = Vec::new();
        for (name, key, has_default, span) in shader.overrides() {
            let set = program
                .constants
                .iter()
                .find(|(constant, _)| constant == name)
                .map(|(_, value)| *value);
            let index = self.scope.and_then(|scope| scope.index);
            let index = index.filter(|_| name == "index").map(f64::from);
            let value = set.or(index).or_else(|| {
                let (param, value) = self.params.get(name)?;
                match value {
                    ParamValue::F32(value) => Some(f64::from(*value)),
                    ParamValue::I32(value) => Some(f64::from(*value)),
                    other => param.as_u32(other).map(f64::from),
                }
            });
            match value {
                Some(value) => constants.push((key, value)),
                None if has_default => {}
                None => self.report(
                    Diagnostic::error(Code::UnknownParam, format!("the override `{name}` has no value"))
                        .at(span, "no param of the document is called so")
                        .help(format!("declare a param `{name}` with a single number, or write `override {name}: … = …;`")),
                ),
            }
        }
        constants
    }

    /// Fills the `params` uniform member by member by name.
    pub(super) fn params_block(
        &mut self,
        global: &Global,
        size: u64,
        members: &[Member],
    ) -> Option<Vec<u8>> {
        let mut bytes = vec![0u8; usize::try_from(size).ok()?];
        let mut complete = true;
        for member in members {
            let Some((param, value)) = self.params.get(&member.name) else {
                let error = Diagnostic::error(
                    Code::UnknownParam,
                    format!(
                        "no param is called `{}`, which the shader's `params` holds",
                        member.name
                    ),
                );
                let error = error.at(global.span.clone(), "").help(format!(
                    "declare it: `params: [(name: \"{}\", type: …, default: …)]`",
                    member.name
                ));
                let found = self.diagnostics.len();
                self.report(error.suggest_to(found, &member.name, || self.params.names()));
                complete = false;
                continue;
            };
            let (expected, words): ((ScalarClass, u32), Vec<u32>) = match (&param.ty, value) {
                (_, ParamValue::F32(value)) => ((ScalarClass::Float, 1), vec![value.to_bits()]),
                (_, ParamValue::I32(value)) => {
                    ((ScalarClass::Sint, 1), vec![value.cast_unsigned()])
                }
                (_, ParamValue::Vec(values)) => {
                    let width = values.len() as u32;
                    (
                        (ScalarClass::Float, width),
                        values.iter().map(|value| value.to_bits()).collect(),
                    )
                }
                (ParamType::U32 | ParamType::Bool | ParamType::Choice(_), value) => (
                    (ScalarClass::Uint, 1),
                    vec![param.as_u32(value).unwrap_or(0)],
                ),
                _ => continue,
            };
            if member.vector != Some(expected) {
                let (scalar, width) = expected;
                let error = Diagnostic::error(
                    Code::LayoutMismatch,
                    format!(
                        "param `{}` is {} × {scalar} in a shader, `params.{}` is not",
                        param.name.value, width, member.name
                    ),
                )
                .at(global.span.clone(), "in this uniform")
                .at(
                    param.name.span.clone(),
                    format!("declared {} here", param.ty),
                );
                self.report(error);
                complete = false;
                continue;
            }
            let at = usize::try_from(member.offset).ok()?;
            for (index, word) in words.iter().enumerate() {
                bytes
                    .get_mut(at + index * 4..at + index * 4 + 4)?
                    .copy_from_slice(&word.to_le_bytes());
            }
        }
        complete.then_some(bytes)
    }
}
