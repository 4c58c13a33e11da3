//! Params on their way into shaders: the `params` uniform and overridable constants.

use super::{linker::Linker, pass::Block};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    document::params::{Param, ParamType, ParamValue},
    errors::link::LinkError,
    kinds::step::Program,
    language::{
        syntax::Expr,
        value::{Scalar, Value},
    },
    shader::{
        class::{Member, ScalarClass},
        reflect::{Global, Shader},
    },
    source::span::{Located, Span},
};

impl ScalarClass {
    /// A number as the bits of one of this class; `None` where it is none.
    fn word(self, scalar: Scalar) -> Option<u32> {
        match (self, scalar) {
            (Self::Float, scalar) => {
                let number = scalar.number() as f32;
                number.is_finite().then(|| number.to_bits())
            }
            (Self::Uint, Scalar::Whole(whole)) => u32::try_from(whole).ok(),
            (Self::Sint, Scalar::Whole(whole)) => i32::try_from(whole).ok().map(i32::cast_unsigned),
            _ => None,
        }
    }
}

/// A value that a shader asks for by name.
enum Asked<'e> {
    /// Value from the entry or a group around it, with its expression.
    Set(Value, &'e Expr),
    /// A value of the document, with its expression's place.
    Value(Value, Span),
    /// A param of the document; which one of the root document it is, unchanged.
    Param(Box<Param>, ParamValue, Option<String>),
    /// The number of the repetition.
    Index(u32),
}

/// Returns a param's value as the words of a uniform.
pub(crate) fn words(param: &Param, value: &ParamValue) -> (ScalarClass, Vec<u32>) {
    match value {
        ParamValue::F32(value) => (ScalarClass::Float, vec![value.to_bits()]),
        ParamValue::I32(value) => (ScalarClass::Sint, vec![value.cast_unsigned()]),
        ParamValue::Vec(values) => {
            let words = values.iter().map(|value| value.to_bits());
            (ScalarClass::Float, words.collect())
        }
        other => (ScalarClass::Uint, vec![param.as_u32(other).unwrap_or(0)]),
    }
}

/// The type of params whose values a member of this type holds.
fn param_of((class, width): (ScalarClass, u32)) -> Option<String> {
    Some(match (class, width) {
        (ScalarClass::Float, 1) => "F32".to_owned(),
        (ScalarClass::Float, _) => format!("Vec{width}"),
        (ScalarClass::Uint, 1) => "U32".to_owned(),
        (ScalarClass::Sint, 1) => "I32".to_owned(),
        _ => return None,
    })
}

impl<'a> Linker<'a, '_> {
    /// The value that a shader asks for: set by the entry, else the index of a repetition, else the
    /// param of that name.
    fn asked(&mut self, name: &str) -> Option<Result<Asked<'a>, ErrorGuaranteed>> {
        self.pass.asked.insert(name.to_owned());
        let position = self.pass.position?;
        let own = self.pass.set.iter().find(|(set, _)| **set == *name);
        let own = own.map(|(_, expr)| (expr, position));
        let said = || {
            let mut said = self.pass.inherited_set.iter();
            let said = said.find(|said| said.name.value == name)?;
            Some((said.value, said.position))
        };
        if let Some((expr, position)) = own.or_else(said) {
            let value = expr.value(&mut self.symbols.at(position, None, self.reports));
            return Some(value.map(|value| Asked::Set(value, expr)));
        }
        if name == "index"
            && let Some(index) = self.symbols.scopes.index(position, None)
        {
            return Some(Ok(Asked::Index(index)));
        }
        let params = &self.symbols.scopes.document(position.scope).params;
        let Some(bound) = params.wgsl_name(name) else {
            let id = self.symbols.scopes.find_wgsl_value(position.scope, name)?;
            let value = self.symbols.value(id, self.reports);
            let span = self.symbols.value_span(id).clone();
            return Some(value.map(|value| Asked::Value(value, span)));
        };
        Some(
            bound
                .value
                .clone()
                .map(|value| Asked::Param(bound.param.clone().into(), value, bound.root.clone())),
        )
    }

    /// Values of overridable constants: from the pass kind, else found by name.
    pub(super) fn constants(
        &mut self,
        program: &Program,
        shader: &Shader,
    ) -> Result<Vec<(String, f64)>, ErrorGuaranteed> {
        let mut constants = Vec::new();
        for (name, key, has_default, span) in shader.overrides() {
            let given = program
                .constants
                .iter()
                .find(|(constant, _)| constant == name);
            if let Some((_, value)) = given {
                constants.push((key, *value));
                continue;
            }
            let value = match self.asked(name).transpose()? {
                Some(asked) => {
                    self.decides(name);
                    self.number(name, &asked, shader, &span)?
                }
                None => self.kind(name),
            };
            match value {
                Some(value) => constants.push((key, value)),
                None if has_default => {}
                None => {
                    let name = Located::new(name.to_owned(), span);
                    return Err(self.report(LinkError::OverrideWithout(name)));
                }
            }
        }
        Ok(constants)
    }

    /// Notes that the plan depends on a param that a shader asks for.
    fn decides(&mut self, name: &str) {
        let Some(position) = self.pass.position else {
            return;
        };
        let params = &self.symbols.scopes.document(position.scope).params;
        if let Some(bound) = params.wgsl_name(name) {
            self.reports.depend_on(bound.roots.iter());
        }
    }

    /// The kind of what is provided, under which the plan is made.
    fn kind(&mut self, name: &str) -> Option<f64> {
        let scope = self.pass.position?.scope;
        let kind = self.symbols.kind_of_wgsl_name(name, scope)?;
        Some(f64::from(kind.number))
    }

    /// A value as one number of the override's type; `span` is the override's place.
    fn number(
        &mut self,
        name: &str,
        asked: &Asked<'_>,
        shader: &Shader,
        span: &Span,
    ) -> Result<Option<f64>, ErrorGuaranteed> {
        let (value, found, position) = match asked {
            Asked::Index(index) => return Ok(Some(f64::from(*index))),
            Asked::Param(param, value, _) => (param.value(value), value.to_string(), span),
            Asked::Set(value, expr) => (value.clone(), value.to_string(), &expr.span),
            Asked::Value(value, span) => (value.clone(), value.to_string(), span),
        };
        let class = shader.override_class(name);
        let number = match (&value, asked, class) {
            (Value::Bool(value), _, None | Some(ScalarClass::Uint)) => {
                Some(f64::from(u8::from(*value)))
            }
            (Value::Word(_), Asked::Set(..) | Asked::Value(..), Some(ScalarClass::Uint)) => {
                Some(f64::from(self.word(name, &value, position, shader)?))
            }
            (Value::Word(_), Asked::Param(param, value, _), Some(ScalarClass::Uint)) => {
                param.as_u32(value).map(f64::from)
            }
            (Value::Scalar(scalar), _, Some(class)) => class.word(*scalar).map(|_| scalar.number()),
            _ => None,
        };
        if number.is_some() {
            return Ok(number);
        }
        let expected = class.map_or("true or false".to_owned(), |class| class.to_string());
        Err(self.report(LinkError::SetValue {
            name: name.to_owned(),
            expected,
            found,
            span: position.clone(),
        }))
    }

    /// The number of a word: its place among those of the document's param of that name, or the
    /// shader's constant.
    fn word(
        &mut self,
        name: &str,
        value: &Value,
        span: &Span,
        shader: &Shader,
    ) -> Result<u32, ErrorGuaranteed> {
        let Value::Word(word) = value else {
            return Err(self.wrong_value(name, "a word", value, span));
        };
        let position = self.pass.position.unwrap_or_else(|| self.symbols.root());
        let params = &self.symbols.scopes.document(position.scope).params;
        let words = params
            .wgsl_name(name)
            .and_then(|bound| match &bound.param.ty {
                ParamType::Choice(words) => Some(words),
                _ => None,
            });
        let among = words.and_then(|words| words.iter().position(|known| *known == word.word));
        if let Some(number) = among.and_then(|number| u32::try_from(number).ok()) {
            return Ok(number);
        }
        let constant = format!("{name}_{}", word.word).to_uppercase();
        match shader.constant(&constant) {
            Some(Scalar::Whole(number)) if words.is_none() => {
                Ok(u32::try_from(number).unwrap_or(u32::MAX))
            }
            _ => Err(self.report(LinkError::UnknownWord {
                name: name.to_owned(),
                word: word.word.to_string(),
                constant,
                span: span.clone(),
            })),
        }
    }

    fn wrong_value(
        &mut self,
        name: &str,
        expected: &str,
        found: &Value,
        span: &Span,
    ) -> ErrorGuaranteed {
        self.report(LinkError::SetValue {
            name: name.to_owned(),
            expected: expected.to_owned(),
            found: found.to_string(),
            span: span.clone(),
        })
    }

    /// Fills the `params` uniform member by member by name.
    pub(super) fn params_block(
        &mut self,
        global: &Global,
        size: u64,
        members: &[Member],
    ) -> Result<Block, ErrorGuaranteed> {
        let mut block = Block {
            // A size beyond the memory is no uniform's; it was refused before.
            bytes: vec![0u8; usize::try_from(size).unwrap_or(0)],
            params: Vec::new(),
        };
        let mut wrong = None;
        for member in members {
            let offset = usize::try_from(member.offset).unwrap_or(0);
            match self.member(global, member) {
                Ok((words, root)) => {
                    block.write(offset, &words);
                    block.params.extend(root.map(|root| (root, offset)));
                }
                Err(reported) => wrong = Some(reported),
            }
        }
        wrong.map_or(Ok(block), Err)
    }

    /// The words of a member of `params`; the param of the root document that it is, unchanged.
    fn member(
        &mut self,
        global: &Global,
        member: &Member,
    ) -> Result<(Vec<u32>, Option<String>), ErrorGuaranteed> {
        let Some(asked) = self.asked(&member.name).transpose()? else {
            let position = self.pass.position.unwrap_or_else(|| self.symbols.root());
            let params = &self.symbols.scopes.document(position.scope).params;
            let known = self.reports.known(params.names());
            return Err(self.report(LinkError::UnknownMember {
                member: member.name.clone(),
                span: global.span.clone(),
                known,
                ty: member.vector.and_then(param_of),
            }));
        };
        let (param, value, root) = match asked {
            Asked::Set(value, expr) => {
                let words = self.set_member(global, member, &value, &expr.span)?;
                return Ok((words, None));
            }
            Asked::Value(value, span) => {
                let words = self.set_member(global, member, &value, &span)?;
                return Ok((words, None));
            }
            Asked::Index(index) => {
                let fits = matches!(member.vector, Some((ScalarClass::Uint, 1)));
                let wrong = || LinkError::IndexMember(global.span.clone());
                return if fits {
                    Ok((vec![index], None))
                } else {
                    Err(self.report(wrong()))
                };
            }
            Asked::Param(param, value, root) => (param, value, root),
        };
        let (scalar, words) = words(&param, &value);
        let expected = (scalar, words.len() as u32);
        if member.vector == Some(expected) {
            return Ok((words, root));
        }
        Err(self.report(LinkError::MemberType {
            param,
            member: member.name.clone(),
            scalar: expected.0,
            width: expected.1,
            span: global.span.clone(),
        }))
    }

    /// The words of a member that the entry sets: the type is the member's.
    fn set_member(
        &mut self,
        global: &Global,
        member: &Member,
        value: &Value,
        span: &Span,
    ) -> Result<Vec<u32>, ErrorGuaranteed> {
        let Some((class, width)) = member.vector else {
            return Err(self.report(LinkError::MemberIsNoVector {
                member: member.name.clone(),
                span: global.span.clone(),
            }));
        };
        let list = match value {
            Value::Scalar(scalar) => vec![*scalar],
            Value::List(list) => list.clone(),
            Value::Bool(value) => vec![Scalar::Whole(i64::from(*value))],
            Value::Word(_) => {
                let position = self.pass.shader.clone();
                let shader = position.map(|name| Program {
                    shader: Some(name),
                    ..Program::default()
                });
                let shader = self.shader(&shader.unwrap_or_default())?;
                let number = self.word(&member.name, value, span, &shader)?;
                vec![Scalar::Whole(number.into())]
            }
            Value::Format(_) => Vec::new(),
        };
        let words: Option<Vec<u32>> = list.iter().map(|scalar| class.word(*scalar)).collect();
        match words.filter(|words| words.len() == width as usize) {
            Some(words) => Ok(words),
            None => {
                let expected = format!("{width} × {class}");
                Err(self.wrong_value(&member.name, &expected, value, span))
            }
        }
    }
}
