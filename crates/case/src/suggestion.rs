//! The nearest name to a misspelt one.

/// The candidate most like `name`, when one is near enough to be what was meant.
///
/// Near: at most one edit in three characters (a transposition counts as one), case ignored.
#[must_use]
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| {
            let edits = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
            (
                edits,
                strsim::damerau_levenshtein(name, candidate),
                candidate,
            )
        })
        .filter(|(edits, _, candidate)| 3 * edits <= candidate.chars().count().max(3))
        .min_by_key(|(edits, with_case, _)| (*edits, *with_case))
        .map(|(_, _, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn misspellings_find_their_name_and_strangers_find_none() {
        let keys = ["end", "cfl", "integrator", "smallest_step"];
        assert_eq!(nearest("edn", keys), Some("end"));
        assert_eq!(nearest("CFL", keys), Some("cfl"));
        assert_eq!(nearest("integrater", keys), Some("integrator"));
        assert_eq!(nearest("smalest_step", keys), Some("smallest_step"));
        assert_eq!(nearest("velocity", keys), None);
        assert_eq!(
            nearest("mss", ["Ms", "ms"]),
            Some("ms"),
            "case decides between equals"
        );
    }
}
