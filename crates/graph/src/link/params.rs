//! Values of params for shaders: the `params` uniform and overridable constants.

use super::pass::Block;
use super::scope::{Asked, PassScope};
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::kinds::Program;
use crate::language::{Scalar, Value, Word};
use crate::param::{Param, ParamValue};
use crate::scalar_class::{ItemScalar, ShaderType};
use crate::shader::{Global, Member, Shader};
use crate::source::{Located, Span};

/// Returns the bits of a number in a shader's scalar type; `None` if the type cannot hold the
/// number.
fn bits(class: ItemScalar, scalar: Scalar) -> Option<u32> {
    match (class, scalar) {
        (ItemScalar::F32, _) if !(scalar.number() as f32).is_finite() => None,
        (ItemScalar::U32 | ItemScalar::I32, Scalar::Number(_)) => None,
        _ => class.bits(scalar.number()),
    }
}

/// Returns a param's value as the words of a uniform.
pub(crate) fn words(param: &Param, value: &ParamValue) -> (ShaderType, Vec<u32>) {
    let (class, words) = match value {
        ParamValue::F32(value) => (ItemScalar::F32, vec![value.to_bits()]),
        ParamValue::I32(value) => (ItemScalar::I32, vec![value.cast_unsigned()]),
        ParamValue::Vec(values) => {
            let words = values.iter().map(|value| value.to_bits());
            (ItemScalar::F32, words.collect())
        }
        other => (ItemScalar::U32, vec![param.as_u32(other).unwrap_or(0)]),
    };
    let width = words.len() as u32;
    (ShaderType { class, width }, words)
}

/// Returns the values of overridable constants: from the pass kind, or else found by name.
pub(super) fn constants(
    program: &Program,
    shader: &Shader,
    scope: &mut PassScope<'_>,
) -> Reported<Vec<(String, f64)>> {
    let mut constants = Vec::new();
    for (name, key, has_default, span) in shader.overrides() {
        let mut given = program.constants.iter();
        if let Some((_, value)) = given.find(|(constant, _)| constant == name) {
            constants.push((key, *value));
            continue;
        }
        let value = match scope.asked(name).transpose()? {
            Some(asked) => {
                // The plan depends on a param that a constant asks for.
                if let Some(bound) = scope.param(name) {
                    let roots = bound.roots.clone();
                    scope.symbols.reports.depend_on(roots.iter());
                }
                scope.check(number(name, &asked, shader, &span, scope))?
            }
            None => scope.kind(name),
        };
        match value {
            Some(value) => constants.push((key, value)),
            None if has_default => {}
            None => {
                let name = Located::new(name.to_owned(), span);
                return Err(scope.report(LinkError::OverrideWithout(name)));
            }
        }
    }
    Ok(constants)
}

/// Converts a value to a number of the override's type; `span` is the place of the override.
fn number(
    name: &str,
    asked: &Asked,
    shader: &Shader,
    span: &Span,
    scope: &PassScope<'_>,
) -> Result<Option<f64>, LinkError> {
    let (value, position) = match asked {
        Asked::Index(index) => return Ok(Some(f64::from(*index))),
        Asked::Param(param, value, _) => (param.value(value), span),
        Asked::Value(value, span) => (value.clone(), span),
    };
    let class = shader.override_class(name);
    let number = match (&value, asked, class) {
        (Value::Bool(value), _, None | Some(ItemScalar::U32)) => Some(f64::from(u8::from(*value))),
        (Value::Word(value), Asked::Value(..), Some(ItemScalar::U32)) => {
            Some(f64::from(word(name, value, position, shader, scope)?))
        }
        (Value::Word(_), Asked::Param(param, value, _), Some(ItemScalar::U32)) => {
            param.as_u32(value).map(f64::from)
        }
        (Value::Scalar(scalar), _, Some(class)) => bits(class, *scalar).map(|_| scalar.number()),
        _ => None,
    };
    if number.is_some() {
        return Ok(number);
    }
    let expected = class.map(|class| ShaderType { class, width: 1 });
    Err(match asked {
        Asked::Param(param, value, _) if expected.is_some() => LinkError::MemberType {
            param: param.clone(),
            member: name.to_owned(),
            needed: words(param, value).0,
            declared: expected,
            span: span.clone(),
        },
        _ => LinkError::SetValue {
            name: name.to_owned(),
            expected,
            value,
            span: position.clone(),
        },
    })
}

/// Returns the number of a word: its index among the words of the document's param of that name, or
/// the shader's constant.
fn word(
    name: &str,
    word: &Word,
    span: &Span,
    shader: &Shader,
    scope: &PassScope<'_>,
) -> Result<u32, LinkError> {
    let words = scope.words(name);
    let among = words.and_then(|words| words.iter().position(|other| *other == word.word));
    if let Some(number) = among.and_then(|number| u32::try_from(number).ok()) {
        return Ok(number);
    }
    let constant = format!("{name}_{}", word.word).to_uppercase();
    match shader.constant(&constant) {
        Some(Scalar::Whole(number)) if words.is_none() => {
            Ok(u32::try_from(number).unwrap_or(u32::MAX))
        }
        _ => Err(LinkError::UnknownWord {
            name: name.to_owned(),
            word: word.word.to_string(),
            constant,
            span: span.clone(),
        }),
    }
}

/// Creates the bytes of the `params` uniform; each member gets the value of its name.
pub(super) fn block(
    global: &Global,
    size: u64,
    members: &[Member],
    scope: &mut PassScope<'_>,
) -> Reported<Block> {
    let most = scope.request().limits.max_uniform_buffer_binding_size;
    if members.is_empty() || size > most {
        return Err(scope.report(LinkError::ParamsUniform {
            what: match members {
                [] => "is not a struct",
                _ => "is too large for the adapter",
            },
            size,
            span: global.span.clone(),
        }));
    }
    let mut block = Block {
        // A size beyond the memory is no uniform's; it was refused before.
        bytes: vec![0u8; usize::try_from(size).unwrap_or(0)],
        params: Vec::new(),
    };
    let mut wrong = None;
    for member in members {
        let offset = usize::try_from(member.offset).unwrap_or(0);
        match member_words(global, member, scope) {
            Ok((words, root)) => {
                block.write(offset, &words);
                block.params.extend(root.map(|root| (root, offset)));
            }
            Err(reported) => wrong = Some(reported),
        }
    }
    wrong.map_or(Ok(block), Err)
}

/// Returns the words of a member of `params`, and the name of the root document's param that it is
/// unchanged (if any).
fn member_words(
    global: &Global,
    member: &Member,
    scope: &mut PassScope<'_>,
) -> Reported<(Vec<u32>, Option<String>)> {
    let Some(asked) = scope.asked(&member.name).transpose()? else {
        let params = scope.symbols.reports.known(scope.params());
        return Err(scope.report(LinkError::UnknownMember {
            member: member.name.clone(),
            span: global.span.clone(),
            params,
            ty: member.vector.and_then(ShaderType::param),
        }));
    };
    let (param, value, root) = match asked {
        Asked::Value(value, span) => {
            let words = set_member(global, member, &value, &span, scope)?;
            return Ok((words, None));
        }
        Asked::Index(index) => {
            return match member.vector {
                Some(ShaderType {
                    class: ItemScalar::U32,
                    width: 1,
                }) => Ok((vec![index], None)),
                _ => Err(scope.report(LinkError::IndexMember(global.span.clone()))),
            };
        }
        Asked::Param(param, value, root) => (param, value, root),
    };
    let (needed, words) = words(&param, &value);
    if member.vector == Some(needed) {
        return Ok((words, root));
    }
    Err(scope.report(LinkError::MemberType {
        param,
        member: format!("params.{}", member.name),
        needed,
        declared: member.vector,
        span: global.span.clone(),
    }))
}

/// Returns the words of a member that the entry sets; the value is converted to the member's type.
fn set_member(
    global: &Global,
    member: &Member,
    value: &Value,
    span: &Span,
    scope: &mut PassScope<'_>,
) -> Reported<Vec<u32>> {
    let Some(expected) = member.vector else {
        let (name, span) = (member.name.clone(), global.span.clone());
        return Err(scope.report(LinkError::MemberIsNoVector(name, span)));
    };
    let list = match value {
        Value::Scalar(scalar) => vec![*scalar],
        Value::List(list) => list.clone(),
        Value::Bool(value) => vec![Scalar::Whole(i64::from(*value))],
        Value::Word(value) => {
            let program = Program {
                shader: scope.own_shader.clone(),
                ..Program::default()
            };
            let shader = scope.shader(&program)?;
            let number = scope.check(word(&member.name, value, span, &shader, scope))?;
            vec![Scalar::Whole(number.into())]
        }
        Value::Format(_) => Vec::new(),
    };
    let list = list.iter();
    let words: Option<Vec<u32>> = list.map(|scalar| bits(expected.class, *scalar)).collect();
    match words.filter(|words| words.len() == expected.width as usize) {
        Some(words) => Ok(words),
        None => Err(scope.report(LinkError::SetValue {
            name: member.name.clone(),
            expected: Some(expected),
            value: value.clone(),
            span: span.clone(),
        })),
    }
}
