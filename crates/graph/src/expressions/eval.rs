//! Evaluates expressions.

use crate::diagnostics::{ErrorGuaranteed, Reported, Reports};
use crate::errors::evaluation::EvaluationError;
use crate::language::{
    AdapterFact, Attribute, Binary, Component, Expr, ExprKind, Function, Name, Reference, Scalar,
    Subject, Unary, Value, Word,
};
use crate::provided_kind::ProvidedKind;
use crate::source::Span;
use std::{cmp::Ordering, mem::discriminant};

/// Gives the names in an expression their values, at the place where the expression stands.
pub(crate) trait Environment {
    /// Returns width and height of the viewport, in pixels.
    fn viewport(&self) -> [u32; 2];

    fn has(&self, feature: wgt::Features) -> bool;

    fn adapter(&self, fact: AdapterFact) -> Value;

    /// Returns the number of items of a buffer that the scene provides, by its name; `None` if it
    /// is not known.
    fn provided_items(&self, _: &str) -> Option<u64> {
        None
    }

    /// True if the scene provides a resource of this name.
    fn is_provided(&self, _: &str) -> bool {
        false
    }

    fn param(&mut self, name: &str, span: &Span) -> Reported<Value>;

    /// True if a param or a named value has this name.
    fn is_param(&self, name: &str) -> bool;

    fn index(&mut self, entry: Option<&Name>, span: &Span) -> Reported<u32>;

    /// Returns the remainder of the frame's number by `length`, in a condition on frames; `None`
    /// elsewhere.
    fn turn(&mut self, _length: u32) -> Option<u32> {
        None
    }

    fn attribute(
        &mut self,
        material: &Reference,
        attribute: Attribute,
        span: &Span,
    ) -> Reported<Value>;

    fn constant(&mut self, name: &str, span: &Span) -> Reported<Value>;

    /// Returns the kind of a provided resource, by its name; `None` if it has none.
    fn kind(&mut self, _name: &str) -> Option<ProvidedKind> {
        None
    }

    fn reports(&mut self) -> &mut Reports;

    fn report(&mut self, error: EvaluationError) -> ErrorGuaranteed {
        self.reports().report(error)
    }
}

/// Evaluates an expression. A mistake in it is reported to `env`.
pub(crate) fn value(expr: &Expr, env: &mut dyn Environment) -> Reported<Value> {
    match &expr.kind {
        ExprKind::Literal(value) => Ok(value.clone()),
        ExprKind::Word(word) => Ok(Value::word(word)),
        ExprKind::Tuple(list) => {
            let list = list.iter().map(|expr| scalar(expr, env));
            Ok(Value::List(list.collect::<Result<_, _>>()?))
        }
        ExprKind::Param(name) => match expr.as_component() {
            Some((owner, at)) if !env.is_param(name) && env.is_param(owner) => {
                let whole = env.param(owner, &expr.span)?;
                component(expr, owner, &whole, at, env)
            }
            _ => env.param(name, &expr.span),
        },
        ExprKind::Attribute(subject, attribute) => match subject {
            Subject::Viewport => of_viewport(expr, *attribute, env),
            Subject::Repetition(entry) => env.index(entry.as_ref(), &expr.span).map(Value::whole),
            Subject::Material(material) => env.attribute(material, *attribute, &expr.span),
        },
        ExprKind::Constant(name) => env.constant(name, &expr.span),
        ExprKind::Has(feature) => Ok(Value::Bool(env.has(*feature))),
        ExprKind::Adapter(fact) => Ok(env.adapter(*fact)),
        ExprKind::Unary(Unary::Not, operand) => Ok(Value::Bool(!boolean(operand, env)?)),
        ExprKind::Unary(Unary::Minus, operand) => {
            let values = [value(operand, env)?, Value::whole(0)];
            each(expr, values, env, |value, _| match value {
                Scalar::Whole(whole) => whole.checked_neg().map(Scalar::Whole),
                Scalar::Number(number) => Some(Scalar::Number(-number)),
            })
        }
        ExprKind::Binary(operator, sides) => binary(expr, *operator, sides, env),
        ExprKind::Ternary(operands) => {
            let [condition, yes, no] = &**operands;
            if boolean(condition, env)? {
                value(yes, env)
            } else {
                value(no, env)
            }
        }
        ExprKind::Call(function, arguments) => call(expr, *function, arguments, env),
        ExprKind::Component(whole, at) => {
            let numbers = value(whole, env)?;
            component(expr, whole.text(), &numbers, *at, env)
        }
    }
}

/// Returns one of the numbers of the value `whole`, that of `owner`.
fn component(
    expr: &Expr,
    owner: &str,
    whole: &Value,
    at: Component,
    env: &mut dyn Environment,
) -> Reported<Value> {
    let number = match whole {
        Value::List(list) => list.get(at as usize),
        _ => None,
    };
    let missing = || EvaluationError::NoComponent {
        place: expr.span.clone(),
        owner: owner.to_owned(),
        component: at.as_str(),
        value: whole.clone(),
    };
    let number = number.copied().ok_or_else(|| env.report(missing()))?;
    Ok(Value::Scalar(number))
}

fn of_viewport(expr: &Expr, attribute: Attribute, env: &mut dyn Environment) -> Reported<Value> {
    let [width, height] = env.viewport();
    Ok(match attribute {
        Attribute::Size => {
            let edges = [width, height].map(|edge| Scalar::Whole(edge.into()));
            Value::List(edges.to_vec())
        }
        Attribute::Width => Value::whole(width),
        Attribute::Height => Value::whole(height),
        Attribute::Count => Value::count(u64::from(width) * u64::from(height)),
        Attribute::Layers | Attribute::Mips | Attribute::Samples => Value::whole(1),
        Attribute::Format | Attribute::Kind | Attribute::Index => {
            let owner = "the viewport".to_owned();
            return Err(env.report(EvaluationError::NoAttribute(expr.span.clone(), owner)));
        }
    })
}

fn wrong(
    expr: &Expr,
    expected: &'static str,
    value: &Value,
    env: &mut dyn Environment,
) -> ErrorGuaranteed {
    let error = EvaluationError::Type(expr.span.clone(), expected, value.clone());
    env.report(error)
}

pub(crate) fn boolean(expr: &Expr, env: &mut dyn Environment) -> Reported<bool> {
    match value(expr, env)? {
        Value::Bool(value) => Ok(value),
        other => Err(wrong(expr, "true or false", &other, env)),
    }
}

pub(crate) fn scalar(expr: &Expr, env: &mut dyn Environment) -> Reported<Scalar> {
    match value(expr, env)? {
        Value::Scalar(scalar) => Ok(scalar),
        other => Err(wrong(expr, "a number", &other, env)),
    }
}

pub(crate) fn number(expr: &Expr, env: &mut dyn Environment) -> Reported<f64> {
    scalar(expr, env).map(Scalar::number)
}

pub(crate) fn whole_number(expr: &Expr, env: &mut dyn Environment) -> Reported<i64> {
    match value(expr, env)? {
        Value::Scalar(Scalar::Whole(whole)) => Ok(whole),
        other => Err(wrong(expr, "a whole number", &other, env)),
    }
}

/// Evaluates an expression that must be an integer of at least 0.
pub(crate) fn count(expr: &Expr, env: &mut dyn Environment) -> Reported<u64> {
    let whole = whole_number(expr, env)?;
    not_negative(expr, whole, 0, env)
}

fn not_negative(expr: &Expr, number: i64, least: u32, env: &mut dyn Environment) -> Reported<u64> {
    let negative = || EvaluationError::Negative(expr.span.clone(), number, least);
    u64::try_from(number).map_err(|_| env.report(negative()))
}

/// Evaluates an expression that must be an integer from 0 to `u32::MAX`.
pub(crate) fn count32(expr: &Expr, env: &mut dyn Environment) -> Reported<u32> {
    let whole = whole_number(expr, env)?;
    let count = not_negative(expr, whole, 1, env)?;
    let large = || EvaluationError::Large(expr.span.clone(), count);
    u32::try_from(count).map_err(|_| env.report(large()))
}

/// Evaluates a size: two or three edges, each an integer of at least 0. A single number is a
/// square.
pub(crate) fn edges(expr: &Expr, env: &mut dyn Environment) -> Reported<Vec<u64>> {
    let list = match value(expr, env)? {
        Value::Scalar(edge) => vec![edge; 2],
        Value::List(list) if list.len() < 4 => list,
        other => return Err(wrong(expr, "a size", &other, env)),
    };
    let edge = |(index, edge)| {
        let part = match &expr.kind {
            ExprKind::Tuple(parts) => parts.get(index).unwrap_or(expr),
            _ => expr,
        };
        match edge {
            Scalar::Whole(whole) => not_negative(part, whole, 1, env),
            other => Err(wrong(part, "a whole number", &Value::Scalar(other), env)),
        }
    };
    list.into_iter().enumerate().map(edge).collect()
}

fn binary(
    expr: &Expr,
    operator: Binary,
    [left, right]: &[Expr; 2],
    env: &mut dyn Environment,
) -> Reported<Value> {
    if matches!(operator, Binary::Remainder) && left.is_frame_number() {
        let length = count32(right, env)?;
        if length > 0
            && let Some(turn) = env.turn(length)
        {
            return Ok(Value::whole(turn));
        }
    }
    let holds: fn(Ordering) -> bool = match operator {
        Binary::Or => return Ok(Value::Bool(boolean(left, env)? || boolean(right, env)?)),
        Binary::And => return Ok(Value::Bool(boolean(left, env)? && boolean(right, env)?)),
        Binary::Equal => return equal([left, right], env).map(Value::Bool),
        Binary::NotEqual => return equal([left, right], env).map(|it| Value::Bool(!it)),
        Binary::Less => Ordering::is_lt,
        Binary::LessEqual => Ordering::is_le,
        Binary::Greater => Ordering::is_gt,
        Binary::GreaterEqual => Ordering::is_ge,
        _ => {
            let values = [value(left, env)?, value(right, env)?];
            if matches!(operator, Binary::ShiftLeft | Binary::ShiftRight) {
                whole_numbers(values.iter().zip([left, right]), env)?;
            }
            let is_zero = |scalar: &Scalar| scalar.number() == 0.0;
            let by_zero = matches!(operator, Binary::Divide | Binary::Remainder);
            if by_zero && values[1].scalars().iter().any(is_zero) {
                return Err(env.report(EvaluationError::DivisionByZero(expr.span.clone())));
            }
            return each(expr, values, env, |a, b| arithmetic(operator, a, b));
        }
    };
    let (a, b) = (scalar(left, env)?, scalar(right, env)?);
    // Whole numbers beyond 2^53 would be equal as floats.
    let order = match (a, b) {
        (Scalar::Whole(a), Scalar::Whole(b)) => Some(a.cmp(&b)),
        _ => a.number().partial_cmp(&b.number()),
    };
    Ok(Value::Bool(order.is_some_and(holds)))
}

fn equal([left, right]: [&Expr; 2], env: &mut dyn Environment) -> Reported<bool> {
    let a = value(left, env)?;
    let b = match (&a, right.as_param()) {
        // Beside a word a bare name is a word, too.
        (
            Value::Word(Word {
                of: Some(words), ..
            }),
            Some(name),
        ) => match words.iter().find(|word| ***word == *name) {
            Some(word) => Value::word(word),
            None => {
                let is_param = Name::new(name).is_ok() && env.is_param(name);
                let resolved = is_param.then(|| env.param(name, &right.span).ok());
                let (span, word) = (right.span.clone(), name.to_owned());
                let unknown = || EvaluationError::NoSuchWord(span, word, words.to_vec());
                let resolved = resolved.flatten();
                resolved.ok_or_else(|| env.report(unknown()))?
            }
        },
        _ => value(right, env)?,
    };
    let numbers = |value: &Value| -> Vec<f64> {
        let scalars = value.scalars().iter();
        scalars.map(|scalar| scalar.number()).collect()
    };
    match (&a, &b) {
        (Value::Scalar(Scalar::Whole(a)), Value::Scalar(Scalar::Whole(b))) => Ok(a == b),
        (Value::Scalar(_), Value::Scalar(_)) | (Value::List(_), Value::List(_)) => {
            Ok(numbers(&a) == numbers(&b))
        }
        _ if discriminant(&a) == discriminant(&b) => Ok(a == b),
        _ => Err(wrong(right, a.describe(), &b, env)),
    }
}

fn call(
    expr: &Expr,
    function: Function,
    arguments: &[Expr],
    env: &mut dyn Environment,
) -> Reported<Value> {
    let mut values = arguments.iter().map(|argument| value(argument, env));
    let first = values.next().transpose()?.unwrap_or(Value::whole(0));
    let second = values.next().transpose()?.unwrap_or(Value::whole(1));
    if function == Function::CeilDiv {
        whole_numbers([&first, &second].into_iter().zip(arguments), env)?;
    }
    each(expr, [first, second], env, |a, b| apply(function, a, b))
}

/// Checks that all numbers of the values are whole; each value has its expression beside it.
fn whole_numbers<'v>(
    values: impl Iterator<Item = (&'v Value, &'v Expr)>,
    env: &mut dyn Environment,
) -> Reported<()> {
    let is_whole = |value: &Value| match value {
        Value::Scalar(Scalar::Whole(_)) => true,
        Value::List(list) => list.iter().all(|part| matches!(part, Scalar::Whole(_))),
        _ => false,
    };
    match values.into_iter().find(|(value, _)| !is_whole(value)) {
        Some((value, expr)) => Err(wrong(expr, "a whole number", value, env)),
        None => Ok(()),
    }
}

/// Applies an operator number by number; one number goes with each of several.
fn each(
    expr: &Expr,
    values: [Value; 2],
    env: &mut dyn Environment,
    apply: impl Fn(Scalar, Scalar) -> Option<Scalar>,
) -> Reported<Value> {
    let apply = |a, b| apply(a, b).filter(|result| result.number().is_finite());
    let result = match &values {
        [Value::Scalar(a), Value::Scalar(b)] => apply(*a, *b).map(Value::Scalar),
        [Value::List(a), Value::List(b)] if a.len() != b.len() => {
            let lengths = [a.len(), b.len()];
            return Err(env.report(EvaluationError::Lengths(expr.span.clone(), lengths)));
        }
        [
            a @ (Value::Scalar(_) | Value::List(_)),
            b @ (Value::Scalar(_) | Value::List(_)),
        ] => {
            let (a, b) = (a.scalars(), b.scalars());
            let pairs = a.iter().cycle().zip(b.iter().cycle());
            let list = pairs.take(a.len().max(b.len())).map(|(a, b)| apply(*a, *b));
            list.collect::<Option<_>>().map(Value::List)
        }
        [Value::Scalar(_) | Value::List(_), other] | [other, _] => {
            return Err(wrong(expr, "a number", other, env));
        }
    };
    result.ok_or_else(|| env.report(EvaluationError::Overflow(expr.span.clone())))
}

/// `None` where the result does not fit.
fn arithmetic(operator: Binary, a: Scalar, b: Scalar) -> Option<Scalar> {
    if let (Scalar::Whole(a), Scalar::Whole(b)) = (a, b) {
        return match operator {
            Binary::Add => a.checked_add(b),
            Binary::Subtract => a.checked_sub(b),
            Binary::Multiply => a.checked_mul(b),
            Binary::Divide => a.checked_div(b),
            Binary::ShiftLeft => shift_left(a, b),
            Binary::ShiftRight => u32::try_from(b).ok().and_then(|bits| a.checked_shr(bits)),
            _ => a.checked_rem(b),
        }
        .map(Scalar::Whole);
    }
    let (a, b) = (a.number(), b.number());
    Some(Scalar::Number(match operator {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        _ => a % b,
    }))
}

/// `None` where bits are lost.
fn shift_left(number: i64, bits: i64) -> Option<i64> {
    let bits = u32::try_from(bits).ok()?;
    let shifted = number.checked_shl(bits)?;
    (shifted >> bits == number).then_some(shifted)
}

fn apply(function: Function, a: Scalar, b: Scalar) -> Option<Scalar> {
    // A value that rounds to a whole number fits into one, or is no size anyway.
    let rounded =
        |number: f64| (number.abs() < i64::MAX as f64).then_some(Scalar::Whole(number as i64));
    match (function, a, b) {
        (Function::CeilDiv, Scalar::Whole(a), Scalar::Whole(b)) => {
            let (quotient, rest) = (a.checked_div(b)?, a.checked_rem(b)?);
            let up = i64::from(rest != 0 && (rest > 0) == (b > 0));
            quotient.checked_add(up).map(Scalar::Whole)
        }
        (Function::CeilDiv, ..) => None,
        (Function::Min, ..) => Some(if b.number() < a.number() { b } else { a }),
        (Function::Max, ..) => Some(if b.number() > a.number() { b } else { a }),
        (Function::Floor, a, _) => rounded(a.number().floor()),
        (Function::Ceil, a, _) => rounded(a.number().ceil()),
        (Function::Exp, a, _) => Some(Scalar::Number(a.number().exp())),
        (Function::Log2, a, _) => Some(Scalar::Number(a.number().log2())),
        (Function::Pow, Scalar::Whole(a), Scalar::Whole(b)) if b >= 0 => {
            a.checked_pow(u32::try_from(b).ok()?).map(Scalar::Whole)
        }
        (Function::Pow, a, b) => Some(Scalar::Number(a.number().powf(b.number()))),
        (Function::Sqrt, a, _) => Some(Scalar::Number(a.number().sqrt())),
    }
}
