//! Pass kinds: types that deserialise the body of an entry in `passes` and lower it to [`Step`]s.

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

/// Body of a pass, read from its entry in `passes`. The type's fields are all fields of the RON
/// entry except `name`, `shader`, `bind`, `set`, `if`, `repeat`, `run`, `clear`, `overwrites` and
/// `reads`, which every kind has.
pub trait PassKind: fmt::Debug + Send + Sync {
    /// Appends the pass's GPU work to `pass`, step by step ([`Lowering::step`]). Called more than
    /// once, and without a GPU: when the document is loaded, and for every plan. It must depend
    /// only on the body and on values that it asks `pass` for. A shader that it uses for some of
    /// these values only must be announced by [`Lowering::alternative`].
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

/// Interface through which a [`PassKind`] lowers its body: it reads the pass's name, shader and
/// values, and takes steps and diagnostics. While a document is loaded, expressions have no value
/// yet, and the methods that evaluate them return a fixed stand-in.
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

    /// Returns the pass's name with its place in the document.
    pub fn name(&self) -> Located<String> {
        self.named(self.name)
    }

    /// Creates the program for the pass's own shader, with the bindings that the document gives.
    /// The shader is that of the field `shader`, or else the one with the pass's name.
    pub fn program(&self) -> Program {
        self.program_with(self.shader.cloned().unwrap_or_else(|| self.name()))
    }

    /// Creates the program for a shader that comes with the pass kind, with the bindings that the
    /// document gives. `shader` is the WGSL file without folder and ending.
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

    /// Returns a name that the pass kind chooses, with the pass as its place: errors about the name
    /// point at the pass.
    pub fn named(&self, name: &str) -> Located<String> {
        Located::new(name.to_owned(), self.name.span.clone())
    }

    /// Adds a buffer of `bytes` bytes that only this pass uses. Captures show it as `pass/name`.
    pub fn scratch(&mut self, name: &str, bytes: u64) -> Scratch {
        self.scratch.push((name.to_owned(), bytes));
        Scratch(self.scratch.len() - 1)
    }

    /// Announces a shader that the pass runs for other values of its expressions only, so that it
    /// is loaded with the document. `shader` comes with the pass kind. Each pair in `imports` is a
    /// module and the module that it imports in its place. `features` are device features that the
    /// pass can make use of.
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

    /// Appends a step to the pass. Steps run in the order in which they are appended.
    pub fn step(&mut self, step: Step<Names>) {
        self.steps.push(step);
    }

    /// Reports a mistake in the pass's body.
    pub fn report(&mut self, mistake: impl Into<Diagnostic>) {
        self.diagnostics.push(mistake.into());
    }

    /// Reports a value that is not allowed, with the message `what`, at the place of its
    /// expression.
    pub fn report_value(&mut self, code: Code, expr: &Expr, what: impl Into<String>) {
        self.report(Diagnostic::error(code, what).at(expr.span.clone(), ""));
    }

    /// Calls `of` with the plan's environment. Returns `fallback` while a document is loaded, and
    /// after a mistake, which was reported.
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

    /// Returns the number of items of the provided buffer `name`, such as `scene.indices`. Returns
    /// 0 if the provider does not know the name or the number, and while a document is loaded.
    pub fn provided_items(&self, name: &str) -> u64 {
        let environment = self.environment.as_ref();
        environment
            .and_then(|it| it.provided_items(name))
            .unwrap_or(0)
    }

    /// Evaluates an expression to a non-negative whole number; 1 while a document is loaded.
    pub fn count(&mut self, expr: &Expr) -> u64 {
        self.evaluate(1, |environment| eval::count(expr, environment))
    }

    /// Evaluates an expression to a non-negative whole number of at most 32 bits; 1 while a
    /// document is loaded.
    pub fn count32(&mut self, expr: &Expr) -> u32 {
        self.evaluate(1, |environment| eval::count32(expr, environment))
    }

    /// Evaluates an expression to a number; 0 while a document is loaded.
    pub fn number(&mut self, expr: &Expr) -> f64 {
        self.evaluate(0.0, |environment| eval::number(expr, environment))
    }

    /// Evaluates an expression to true or false; false while a document is loaded.
    pub fn boolean(&mut self, expr: &Expr) -> bool {
        self.evaluate(false, |environment| eval::boolean(expr, environment))
    }

    /// Returns the word for the kind of the provided resource `name`, such as the kind of `light`.
    /// Returns `None` if the resource has no kind, and while a document is loaded.
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

    /// Returns one thread for each texel of a texture or of a part of it: of the first mip that it
    /// selects, and of all slices of a 3D texture, but of one layer of an array. One thread while a
    /// document is loaded.
    pub fn texels(&mut self, texture: &Reference) -> Threads {
        let of = Subject::Material(Box::new(texture.clone()));
        let size = ExprKind::Attribute(of, Attribute::Size);
        let size = self.list(&Expr::new(size, texture.span.clone()));
        let edge = |edge: usize| size.get(edge).and_then(|edge| edge.whole()).unwrap_or(1);
        Threads::Texels([edge(0), edge(1), edge(2)])
    }

    /// Returns the branch that a conditional expression `condition ? yes : no` selects,
    /// unevaluated; any other expression itself. The last branch while a document is loaded.
    pub(crate) fn branch<'e>(&mut self, expr: &'e Expr) -> &'e Expr {
        let mut expr = expr;
        while let ExprKind::Ternary(of) = &expr.kind {
            let [condition, yes, no] = &**of;
            expr = if self.boolean(condition) { yes } else { no };
        }
        expr
    }

    /// Returns the value in `words` of the word that `chosen` is or evaluates to. If `chosen` is a
    /// `Choice` param, all words of the param must be in `words`, so that a document fails for all
    /// values of a param or for none. Returns the value of the first word while a document is
    /// loaded, and after a mistake, which was reported. `words` must not be empty.
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
