//! Suggestions for misspelt names: "did you mean …?"

/// Names that a misspelt one is compared with: a document may hold thousands, and as many mistakes.
const COMPARED: usize = 1024;

/// Bytes of a name that can be compared, which takes time by the square, and that is worth a place
/// in a list.
const LONGEST: usize = 80;

/// Names in a list.
const SHOWN: usize = 16;

/// Returns the name in `names` that is most like the misspelt `word`, by similarity of the letters;
/// `None` if no name is close enough or `word` has more than 80 bytes. A dotted name that ends in
/// `.word` counts as closest if it is the only one that does. Names of more than 80 bytes, and
/// those after the first 1,024 others, are not compared.
pub fn closest<'k>(word: &str, names: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    if word.len() > LONGEST {
        return None;
    }
    let names = names.into_iter().filter(|name| name.len() <= LONGEST);
    let names: Vec<&str> = names.take(COMPARED).collect();
    // A name that a named include exposes begins with the include's name.
    let mut exposed = names.iter().filter(|name| {
        let own = name.rsplit_once('.').map(|(_, own)| own);
        own == Some(word)
    });
    if let (Some(name), None) = (exposed.next(), exposed.next()) {
        return Some(*name);
    }
    let likeness = names.into_iter().map(|name| {
        let likeness = strsim::jaro_winkler(word, name);
        // It has no eye for a slip in a short name; the share of letters that stay has.
        let stays = strsim::normalized_damerau_levenshtein(word, name);
        (likeness, stays, name)
    });
    // Below that two names share little more than a letter or two; a list helps more than a wild
    // guess.
    let like = likeness.filter(|(likeness, stays, _)| *likeness >= 0.8 || *stays > 0.66);
    let best = like.max_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
    best.map(|(.., name)| name)
}

/// Returns a hint for a misspelt `word`: "did you mean …?" with the [`closest`] name in `names`, or
/// else "known here: …" with the first 16 names in `names` and the number of the others. Names of
/// more than 80 bytes are left out. `None` if no name is left.
pub fn suggestion<S: AsRef<str>>(word: &str, names: impl IntoIterator<Item = S>) -> Option<String> {
    let names: Vec<S> = names.into_iter().collect();
    let count = names.len();
    let short = |name: &&str| name.len() <= LONGEST;
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).filter(short).collect();
    if let Some(name) = closest(word, names.iter().copied()) {
        return Some(format!("did you mean `{name}`?"));
    }
    if names.is_empty() {
        return None;
    }
    let rest = count - names.len().min(SHOWN);
    let shown = names.iter().take(SHOWN).map(|name| format!("`{name}`"));
    let mut list = shown.collect::<Vec<_>>().join(", ");
    if rest > 0 {
        list.push_str(&format!(" and {rest} more"));
    }
    Some(format!("known here: {list}"))
}

/// Returns the hint "did you mean …?" for a misspelt `word`, with the [`closest`] name in `names`;
/// `None` if no name is close enough.
pub fn likeness<S: AsRef<str>>(word: &str, names: impl IntoIterator<Item = S>) -> Option<String> {
    suggestion(word, names).filter(|hint| hint.starts_with("did"))
}
