//! Pass kinds: types that deserialise the body of an entry in `passes` and lower it to [`Step`]s.

use super::step::{Names, Operand, Program, Scratch, ShaderUse, Step, Threads};
use crate::diagnostics::{Code, Diagnostic, Reported};
use crate::errors::evaluation::EvaluationError;
use crate::expressions::{Environment, eval};
use crate::fields::Chosen;
use crate::language::{Attribute, Expr, ExprKind, Name, Reference, Scalar, Subject, Value};
use crate::source::Located;
use std::fmt;

/// A kind of pass, such as `Raster`. A value of the type is the body of one pass, deserialised from
/// its entry in a document's `passes`: all fields except `name`, `shader`, `bind`, `set`, `if`,
/// `repeat`, `run`, `clear`, `overwrites` and `reads`, which entries of every kind have. Documents
/// may use it once it is [registered](crate::Registry::register); the module [`step`](crate::step)
/// has an example. Fields of the types [`Expr`], [`Reference`] and [`Chosen`] hold expressions,
/// references and words. A field that the type lacks is a mistake in the document only if the type
/// says so to serde (`deny_unknown_fields`).
pub trait PassKind: fmt::Debug + Send + Sync {
    /// Lowers the body to steps: appends the pass's GPU work to `pass`, step by step
    /// ([`Lowering::step`]). Called more than once, and without a GPU: when the document is loaded,
    /// and for every plan. It must depend only on the body and on values that it asks `pass` for. A
    /// shader that it uses with some of these values and not with others must be announced by
    /// [`Lowering::alternative`] in every call.
    fn lower(&self, pass: &mut Lowering<'_>);
}

/// Fields that passes of every kind have.
pub(crate) const OF_PASS: [&str; 10] = [
    "name",
    "shader",
    "bind",
    "set",
    "if",
    "repeat",
    "run",
    "clear",
    "overwrites",
    "reads",
];

/// Interface through which a [`PassKind`] turns its body, the fields of one pass, into steps: it
/// gives the kind the pass's name, shader and values, and collects steps and diagnostics. While a
/// document is loaded, expressions have no value yet, and the methods that evaluate them return a
/// fixed substitute.
pub struct Lowering<'a> {
    pub(crate) name: &'a Located<Name>,
    pub(crate) shader: Option<&'a Located<String>>,
    /// Bindings that the document gives the globals of the pass's own shader.
    pub(crate) bind: &'a [(Located<String>, Reference)],
    /// Values of expressions; `None` while a document is loaded.
    pub(crate) environment: Option<&'a mut dyn Environment>,
    pub(crate) steps: Vec<Step<Names>>,
    /// Shaders that the pass runs for other values only.
    pub(crate) alternatives: Vec<ShaderUse>,
    pub(crate) features: wgt::Features,
    /// Name and size in bytes of each buffer that only this pass uses.
    pub(crate) scratch: Vec<(String, u64)>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Conditions that decide the form of the pass.
    pub(crate) conditions: Vec<Expr>,
}

impl<'a> Lowering<'a> {
    pub(crate) fn new(
        name: &'a Located<Name>,
        shader: Option<&'a Located<String>>,
        bind: &'a [(Located<String>, Reference)],
        environment: Option<&'a mut dyn Environment>,
    ) -> Self {
        Self {
            name,
            shader,
            bind,
            environment,
            // Most have one, and it is large.
            steps: Vec::with_capacity(1),
            alternatives: Vec::new(),
            features: wgt::Features::empty(),
            scratch: Vec::new(),
            diagnostics: Vec::new(),
            conditions: Vec::new(),
        }
    }

    /// Returns the pass's name as its document writes it, without the names of includes and groups
    /// around it and without the index of a repetition, with its place in the document.
    pub fn name(&self) -> Located<String> {
        self.named(self.name)
    }

    /// Returns a program for the pass's own shader, with the bindings of the entry's field `bind`.
    /// The shader is the one that the entry's field `shader` names, or else the one with the pass's
    /// name. Entry points are left open: each stage has the only one in the shader.
    pub fn program(&self) -> Program {
        self.program_with(self.shader.cloned().unwrap_or_else(|| self.name()))
    }

    /// Returns a program for a shader that comes with the pass kind, with the bindings of the
    /// entry's field `bind`. `shader` is the name of the WGSL file in the folder `shaders` of the
    /// [`Sources`](crate::Sources) that the graph is loaded from, without ending: a crate with pass
    /// kinds serves its shaders by sources of its own ([`LayeredSources`](crate::LayeredSources)).
    /// Entry points are left open: each stage has the only one in the shader.
    pub fn program_of(&self, shader: &str) -> Program {
        self.program_with(self.named(shader))
    }

    fn program_with(&self, shader: Located<String>) -> Program {
        let bind = self.bind.iter();
        Program {
            shader: Some(shader),
            bind: bind
                .map(|(global, to)| (global.clone(), Operand::from(to)))
                .collect(),
            ..Program::default()
        }
    }

    /// Returns `name`, chosen by the pass kind and not written in the document, with the place of
    /// the pass: errors about the name point at the pass.
    pub fn named(&self, name: &str) -> Located<String> {
        Located::new(name.to_owned(), self.name.span.clone())
    }

    /// Adds a buffer of `bytes` bytes, rounded up to a multiple of 4 and to at least one item of
    /// the shaders that bind it (so 0 is allowed), that only this pass uses, and returns its handle
    /// for steps. A step must write it before another reads it, in every frame. Each buffer of a
    /// pass needs its own `name`. A capture reads it as the material `pass/name`, where `pass` is
    /// the [full name](crate#terms) of the pass.
    pub fn scratch(&mut self, name: &str, bytes: u64) -> Scratch {
        self.scratch.push((name.to_owned(), bytes));
        Scratch(self.scratch.len() - 1)
    }

    /// Announces a shader that the pass runs with some values of its expressions and not with
    /// others, whether this call appends a step with it or not. So it is loaded with the document,
    /// and a plan with other values finds it. `shader` is the name of a WGSL file that comes with
    /// the pass kind, without folder and ending. `imports` are those of
    /// [`Program::imports`]. `features` are device
    /// features that the pass uses if the device has them.
    pub fn alternative(
        &mut self,
        shader: &str,
        imports: &[(Located<String>, Located<String>)],
        features: wgt::Features,
    ) {
        self.alternatives.push(ShaderUse {
            name: self.named(shader),
            imports: imports.to_vec(),
        });
        self.features |= features;
    }

    /// Appends a step (a draw, dispatch, copy, clear or work for the CPU) to the pass. Steps run in
    /// the order in which they are appended.
    pub fn step(&mut self, step: Step<Names>) {
        self.steps.push(step);
    }

    /// Reports a mistake in the pass's body, an error or a warning, which planning returns. While a
    /// document is loaded, when expressions have no value yet, reports are ignored.
    pub fn report(&mut self, mistake: impl Into<Diagnostic>) {
        self.diagnostics.push(mistake.into());
    }

    /// Reports an error of kind `code` at the place of the expression `expr`, whose value is not
    /// allowed. `what` is the message. It is ignored while a document is loaded, when expressions
    /// have no value yet.
    pub fn report_value(&mut self, code: Code, expr: &Expr, what: impl Into<String>) {
        self.report(Diagnostic::error(code, what).at(expr.span.clone(), ""));
    }

    /// Calls `evaluator` with the plan's environment. Returns `fallback` while a document is
    /// loaded, and after a mistake, which was reported.
    fn evaluate<T>(
        &mut self,
        fallback: T,
        evaluator: impl FnOnce(&mut dyn Environment) -> Reported<T>,
    ) -> T {
        match &mut self.environment {
            Some(environment) => evaluator(&mut **environment).unwrap_or(fallback),
            None => fallback,
        }
    }

    /// Returns the number of [items](crate#terms) of the buffer `name` that the host's
    /// [provider](crate#terms) describes, such as `scene.indices`; also if an include binds a
    /// material to the name. Returns 0 if the provider does not know the name or the number, and
    /// while a document is loaded.
    pub fn provided_items(&self, name: &str) -> u64 {
        let environment = self.environment.as_ref();
        let items = environment.and_then(|it| it.provided_items(name));
        items.unwrap_or(0)
    }

    /// True if the provider has a resource of this name, also if an include binds a material to the
    /// name; and while a document is loaded.
    pub fn is_provided(&self, name: &str) -> bool {
        let environment = self.environment.as_ref();
        environment.is_none_or(|it| it.is_provided(name))
    }

    /// Evaluates an expression to a non-negative whole number. Returns 1 while a document is
    /// loaded, and after a mistake, which is reported.
    pub fn count(&mut self, expr: &Expr) -> u64 {
        self.evaluate(1, |environment| eval::count(expr, environment))
    }

    /// Evaluates an expression to a non-negative whole number of at most 32 bits. Returns 1 while a
    /// document is loaded, and after a mistake, which is reported.
    pub fn count32(&mut self, expr: &Expr) -> u32 {
        self.evaluate(1, |environment| eval::count32(expr, environment))
    }

    /// Evaluates an expression to a number, an integer or a float. Returns 0 while a document is
    /// loaded, and after a mistake, which is reported.
    pub fn number(&mut self, expr: &Expr) -> f64 {
        self.evaluate(0.0, |environment| eval::number(expr, environment))
    }

    /// Evaluates an expression to true or false. Returns false while a document is
    /// loaded, and after a mistake, which is reported.
    pub fn boolean(&mut self, expr: &Expr) -> bool {
        self.evaluate(false, |environment| eval::boolean(expr, environment))
    }

    /// Evaluates a condition that decides the form of the pass, so that a document is checked for
    /// either value. Returns true while a document is loaded, and after a mistake, which is
    /// reported.
    pub(crate) fn condition(&mut self, condition: &Expr) -> bool {
        self.conditions.push(condition.clone());
        self.evaluate(true, |environment| eval::boolean(condition, environment))
    }

    /// Returns the word for the kind of the resource `name` that the host's [provider](crate#terms)
    /// describes, such as `spot` for a `light`; the first word of its kinds if an include binds a
    /// material to the name. Returns `None` if the provider does not know the name or the resource
    /// has no kind, and while a document is loaded.
    pub fn kind_of(&mut self, name: &str) -> Option<&'static str> {
        let environment = self.environment.as_mut()?;
        environment.kind(name).map(|kind| kind.word())
    }

    /// Evaluates an expression to one or several numbers; empty while a document is loaded.
    pub(crate) fn list(&mut self, expr: &Expr) -> Vec<Scalar> {
        self.evaluate(Vec::new(), |environment| {
            Ok(match eval::value(expr, environment)? {
                Value::List(list) => list,
                _ => vec![eval::scalar(expr, environment)?],
            })
        })
    }

    /// Evaluates an expression to the two or three edges of a size; one number stands for two equal
    /// edges. Edges of 1 while a document is loaded.
    pub(crate) fn edges(&mut self, expr: &Expr) -> Vec<u64> {
        self.evaluate(vec![1, 1], |environment| eval::edges(expr, environment))
    }

    /// Returns one thread for each texel of the texture, or part of it, that `texture` refers to:
    /// of its first mip, and of all slices of a 3D texture, but of one layer of an array. Returns
    /// one thread while a document is loaded, and after a mistake, which is reported.
    pub fn texels(&mut self, texture: &Reference) -> Threads {
        let subject = Subject::Material(Box::new(texture.clone()));
        let size = ExprKind::Attribute(subject, Attribute::Size);
        let size = self.list(&Expr::new(size, texture.span.clone()));
        let edge = |edge: usize| size.get(edge).and_then(|edge| edge.whole()).unwrap_or(1);
        Threads::Texels([edge(0), edge(1), edge(2)])
    }

    /// Returns the branch that a conditional expression `condition ? yes : no` selects,
    /// unevaluated; any other expression itself. The last branch while a document is loaded.
    pub(crate) fn branch<'e>(&mut self, expr: &'e Expr) -> &'e Expr {
        let mut expr = expr;
        while let ExprKind::Ternary(operands) = &expr.kind {
            let [condition, yes, no] = &**operands;
            expr = if self.boolean(condition) { yes } else { no };
        }
        expr
    }

    /// Returns the value of the field `chosen`: the word in it, or the value that `words` has for
    /// the word that its expression yields. If the expression is a `Choice` param, all words of the
    /// param must be in `words`, so that a document fails for all values of a param or for none.
    /// Returns the first value in `words` while a document is loaded, and after a mistake, which is
    /// reported. `words` must not be empty.
    pub fn word<T: Copy>(&mut self, chosen: &Chosen<T>, words: &[(&str, T)]) -> T {
        let whole = match chosen {
            Chosen::Word(word) => return *word,
            Chosen::Expr(expr) => expr,
        };
        let expr = self.branch(whole);
        let named = |name: &Name| words.iter().find(|(word, _)| **word == **name);
        // Behind a condition a bare name is a word.
        if !std::ptr::eq(expr, whole)
            && let Some(name) = expr.as_param()
            && let Some((_, value)) = words.iter().find(|(word, _)| *word == name)
        {
            return *value;
        }
        self.evaluate(words[0].1, |environment| {
            let value = eval::value(expr, environment)?;
            if let Value::Word(word) = &value
                && (word.of.iter().flat_map(|words| words.iter())).all(|word| named(word).is_some())
                && let Some((_, value)) = named(&word.word)
            {
                return Ok(*value);
            }
            let expected = words.iter().map(|(word, _)| (*word).to_owned()).collect();
            Err(environment.report(EvaluationError::Words(expr.span.clone(), expected, value)))
        })
    }
}
