//! Pass kinds: types that deserialise their own body and lower it to [`Step`]s.

use super::step::{Names, Operand, Program, Scratch, ShaderUse, Step, Threads};
use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic, reports::ErrorGuaranteed},
    errors::evaluation::EvaluationError,
    expressions::eval::{self, Environment},
    fields::Chosen,
    language::{
        name::Name,
        syntax::{Attribute, Expr, ExprKind, Reference, Subject},
        value::{Scalar, Value},
    },
    source::span::Located,
};
use std::fmt;

/// The body of a pass of some kind. Its fields are what the RON entry holds beside `name`,
/// `shader`, `bind`, `set`, `if`, `repeat`, `run`, `clear`, `overwrites` and `reads`.
pub trait PassKind: fmt::Debug + Send + Sync {
    /// Says which GPU work the pass is, in order. Called without a GPU, more than once; it must
    /// depend on nothing but the body and values that it asks for. A shader that it names only for
    /// some of these is a [`Lowering::alternative`].
    fn lower(&self, pass: &mut Lowering<'_>);
}

/// Fields of a pass beside those of its kind.
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

/// Surroundings in which a [`PassKind`] lowers: the pass's name, shader and values in, steps and
/// diagnostics out.
pub struct Lowering<'a> {
    pub(crate) name: &'a Located<Name>,
    pub(crate) shader: Option<&'a Located<String>>,
    /// Bindings of the pass for its own shader's globals.
    pub(crate) bind: &'a [(Located<String>, Reference)],
    /// `None` where a document is only read: nothing has a value then.
    pub(crate) environment: Option<&'a mut dyn Environment>,
    pub(crate) steps: Vec<Step<Names>>,
    /// Shaders that are named for other values.
    pub(crate) alternatives: Vec<ShaderUse>,
    pub(crate) features: wgt::Features,
    /// Name and bytes of the pass's own buffers.
    pub(crate) scratch: Vec<(String, u64)>,
    pub(crate) diagnostics: Vec<Diagnostic>,
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
        }
    }

    /// The pass's name with its place in the document.
    pub fn name(&self) -> Located<String> {
        self.named(self.name)
    }

    /// The program of the pass's own shader (its `shader` field, else its name) with the bindings
    /// the document gives.
    pub fn program(&self) -> Program {
        self.program_with(self.shader.cloned().unwrap_or_else(|| self.name()))
    }

    /// The program of a shader that comes with the pass kind.
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

    /// A name that the kind itself gives; errors about it point at the pass.
    pub fn named(&self, name: &str) -> Located<String> {
        Located::new(name.to_owned(), self.name.span.clone())
    }

    /// Adds a buffer of `bytes` that only this pass uses; `name` is what captures show.
    pub fn scratch(&mut self, name: &str, bytes: u64) -> Scratch {
        self.scratch.push((name.to_owned(), bytes));
        Scratch(self.scratch.len() - 1)
    }

    /// Says that for other values a step may run this shader, which comes with the kind, with these
    /// modules in the place of others, and that it can make use of these features of a device.
    pub fn alternative(&mut self, shader: &str, imports: &[(&str, &str)], features: wgt::Features) {
        let imports = imports.iter();
        self.alternatives.push(ShaderUse {
            name: self.named(shader),
            imports: imports
                .map(|(of, is)| ((*of).to_owned(), (*is).to_owned()))
                .collect(),
        });
        self.features |= features;
    }

    /// Appends a step.
    pub fn step(&mut self, step: Step<Names>) {
        self.steps.push(step);
    }

    /// Reports a mistake in the body.
    pub fn report(&mut self, mistake: impl Into<Diagnostic>) {
        self.diagnostics.push(mistake.into());
    }

    /// Reports a value that cannot be, at the expression that it is.
    pub fn report_value(&mut self, code: Code, expr: &Expr, what: impl Into<String>) {
        self.report(Diagnostic::error(code, what).at(expr.span.clone(), ""));
    }

    /// Applies `of` to an expression in the plan's environment. Returns `fallback` where nothing
    /// has a value, or after a mistake, which was reported.
    fn evaluate<T>(
        &mut self,
        fallback: T,
        of: impl FnOnce(&mut dyn Environment) -> Result<T, ErrorGuaranteed>,
    ) -> T {
        match &mut self.environment {
            Some(environment) => of(&mut **environment).unwrap_or(fallback),
            None => fallback,
        }
    }

    /// How many items the scene provides under a name; none where it provides nothing of that name,
    /// does not say, or the document is only read.
    pub fn provided_items(&self, name: &str) -> u64 {
        let environment = self.environment.as_ref();
        environment
            .and_then(|it| it.provided_items(name))
            .unwrap_or(0)
    }

    /// A number of things; 1 where the document is only read.
    pub fn count(&mut self, expr: &Expr) -> u64 {
        self.evaluate(1, |environment| eval::count(expr, environment))
    }

    /// A number of things that 32 bits hold; 1 where the document is only read.
    pub fn count32(&mut self, expr: &Expr) -> u32 {
        self.evaluate(1, |environment| eval::count32(expr, environment))
    }

    /// A number; 0 where the document is only read.
    pub fn number(&mut self, expr: &Expr) -> f64 {
        self.evaluate(0.0, |environment| eval::number(expr, environment))
    }

    /// True or false; false where the document is only read.
    pub fn boolean(&mut self, expr: &Expr) -> bool {
        self.evaluate(false, |environment| eval::boolean(expr, environment))
    }

    /// The word for the kind of something that is provided, where it has one; `None` where the
    /// document is only read.
    pub fn kind_of(&mut self, name: &str) -> Option<&'static str> {
        let environment = self.environment.as_mut()?;
        environment.kind(name).map(|kind| kind.word())
    }

    /// One number, or several; none where the document is only read.
    pub(crate) fn list(&mut self, expr: &Expr) -> Vec<Scalar> {
        self.evaluate(Vec::new(), |environment| {
            Ok(match eval::value(expr, environment)? {
                Value::List(list) => list,
                _ => vec![eval::scalar(expr, environment)?],
            })
        })
    }

    /// Two or three edges, two equal ones of one number; of one texel where the document is only
    /// read.
    pub(crate) fn edges(&mut self, expr: &Expr) -> Vec<u64> {
        self.evaluate(vec![1, 1], |environment| eval::edges(expr, environment))
    }

    /// A thread for each texel of a texture; one where the document is only read.
    pub fn texels(&mut self, texture: &Reference) -> Threads {
        let of = Subject::Material(Box::new(texture.clone()));
        let size = ExprKind::Attribute(of, Attribute::Size);
        let size = self.list(&Expr::new(size, texture.span.clone()));
        let edge = |edge: usize| size.get(edge).and_then(|edge| edge.whole()).unwrap_or(1);
        Threads::Texels([edge(0), edge(1), edge(2)])
    }

    /// Returns the branch of an expression whose condition holds, before it is evaluated; the last
    /// one where the document is only read.
    pub(crate) fn branch<'e>(&mut self, expr: &'e Expr) -> &'e Expr {
        let mut expr = expr;
        while let ExprKind::Ternary(of) = &expr.kind {
            let [condition, yes, no] = &**of;
            expr = if self.boolean(condition) { yes } else { no };
        }
        expr
    }

    /// A word of the language that may be that of a `Choice` param, all of whose words must be in
    /// `words`: a document must not fail on some of its params' values. The first where the
    /// document is only read. `words` must not be empty.
    pub fn word<T: Copy>(&mut self, chosen: &Chosen<T>, words: &[(&str, T)]) -> T {
        let whole = match chosen {
            Chosen::Word(word) => return *word,
            Chosen::Expr(expr) => expr,
        };
        let expr = self.branch(whole);
        let known = |name: &Name| words.iter().find(|(word, _)| **word == **name);
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
                && word
                    .of
                    .iter()
                    .flat_map(|of| of.iter())
                    .all(|word| known(word).is_some())
                && let Some((_, value)) = known(&word.word)
            {
                return Ok(*value);
            }
            let expected = words.iter().map(|(word, _)| (*word).to_owned()).collect();
            Err(environment.report(EvaluationError::Words {
                span: expr.span.clone(),
                expected,
                found: value,
            }))
        })
    }
}
