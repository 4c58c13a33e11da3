//! Constants for the words of `Choice` params, in the shaders of their document: the param `cull`
//! with the word `none` gives `const CULL_NONE: u32 = 0u;`.

use super::{expand::Expanded, reflect::Shader, text::identifiers};
use crate::errors::shader::ShaderError;
use crate::param::{Param, ParamType};
use crate::source::Located;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Constants for the words of a document's `Choice` params, by name.
#[derive(Debug, Default)]
pub(crate) struct ChoiceConstants(BTreeMap<String, ChoiceConstant>);

#[derive(Debug)]
struct ChoiceConstant {
    number: u32,
    param: Located<String>,
    word: String,
}

impl ChoiceConstants {
    /// Creates the constants for the words of all `Choice` params in `params`. Also returns an
    /// error for each two words that give constants of one name.
    pub fn new(params: &[Param]) -> (Self, Vec<ShaderError>) {
        let (mut constants, mut clashes) = (BTreeMap::<String, ChoiceConstant>::new(), Vec::new());
        for param in params {
            let ParamType::Choice(words) = &param.ty else {
                continue;
            };
            for (number, word) in (0u32..).zip(words.iter()) {
                let name = constant_name(&param.name, word);
                let constant = ChoiceConstant {
                    number,
                    param: param.name.clone(),
                    word: word.to_string(),
                };
                if let Some(first) = constants.get(&name) {
                    let (first, second) = (first.param.span.clone(), constant.param.span);
                    clashes.push(ShaderError::TwoWords(name, first, second));
                    continue;
                }
                constants.insert(name, constant);
            }
        }
        (Self(constants), clashes)
    }

    /// Appends to the shader's text the constants that it uses without declaring them. Returns the
    /// names of the constants that the text declares itself.
    pub fn append(&self, source: &mut Expanded) -> Vec<&str> {
        let mut used: HashMap<&str, bool> = HashMap::new();
        for (word, before, is_outside) in identifiers(&source.text) {
            if let Some((name, _)) = self.0.get_key_value(word) {
                *used.entry(name).or_default() |= is_outside && before == "const";
            }
        }
        let (declared, missing): (BTreeSet<_>, BTreeSet<_>) =
            used.into_iter().partition(|(_, is_declared)| *is_declared);
        for (name, _) in missing {
            let constant = &self.0[name];
            let text = format!("\nconst {name}: u32 = {}u;\n", constant.number);
            source.push(&text, &constant.param.span);
        }
        source.constants = self.0.keys().cloned().collect();
        declared.into_iter().map(|(name, _)| name).collect()
    }

    /// Returns an error for the first constant in `declared` whose number is not the index of its
    /// word; `None` if all agree.
    pub fn disagreement(&self, shader: &Shader, declared: &[&str]) -> Option<ShaderError> {
        declared.iter().find_map(|name| {
            let constant = self.0.get(*name)?;
            let value = shader.constant(name)?;
            let agrees = value.number() == f64::from(constant.number);
            (!agrees).then(|| ShaderError::Choice {
                constant: (*name).to_owned(),
                value: value.to_string(),
                word: format!("`{}`", constant.word),
                param: constant.param.clone(),
                number: constant.number,
                at: shader.constant_span(name),
            })
        })
    }
}

/// `CULL_FRONT` of `cull` and `front`; of `left.cull`, `LEFT_CULL_FRONT`.
fn constant_name(param: &str, word: &str) -> String {
    format!("{param}_{word}").replace('.', "_").to_uppercase()
}
