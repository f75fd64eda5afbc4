use super::*;

fn bytes_of(data: &RestartData) -> Vec<u8> {
    let mut bytes = Vec::new();
    check(data).unwrap();
    let header = encoded(Path::new("a"), &data.header).unwrap();
    let arrays: Vec<RestartPieces<'_>> = data.arrays.iter().map(RestartPieces::from).collect();
    encode(&header, &arrays, &mut bytes).unwrap();
    bytes
}
use serde_json::json;

fn sample() -> RestartData {
    RestartData {
        header: json!({ "time": 0.1 + 0.2, "dt": 2.2250738585072e-310, "step": 12 }),
        arrays: vec![
            RestartArray {
                name: "momentum".to_owned(),
                shape: vec![2, 3],
                values: vec![
                    -0.0,
                    5e-324,
                    f64::MAX,
                    f64::NAN,
                    f64::NEG_INFINITY,
                    1.0 / 3.0,
                ],
            },
            RestartArray {
                name: "empty".to_owned(),
                shape: vec![0, 3],
                values: vec![],
            },
        ],
    }
}

fn assert_same_bits(a: &RestartData, b: &RestartData) {
    assert_eq!(a.header, b.header);
    assert_eq!(a.arrays.len(), b.arrays.len());
    for (a, b) in a.arrays.iter().zip(&b.arrays) {
        assert_eq!((&a.name, &a.shape), (&b.name, &b.shape));
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&a.values), bits(&b.values));
    }
}

fn numbered(step: u64) -> RestartData {
    RestartData {
        header: json!(step),
        arrays: vec![],
    }
}

fn steps(folder: &Path) -> Vec<u64> {
    states(folder).unwrap().iter().map(|(s, _)| *s).collect()
}

#[test]
fn every_bit_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_restart(folder.path(), 12, &sample()).unwrap();
    assert!(path.ends_with("state-000000000012.jstsph"));
    let (data, warnings) = read_latest_restart(folder.path()).unwrap();
    assert_same_bits(&data, &sample());
    assert!(warnings.is_empty());
    assert_eq!(data.array("momentum").map(|a| a.values.len()), Some(6));
}

#[test]
fn every_flipped_bit_and_every_truncation_is_noticed() {
    let bytes = bytes_of(&sample());
    assert_same_bits(&decode(&bytes).unwrap(), &sample());
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut flipped = bytes.clone();
            flipped[at] ^= 1 << bit;
            assert!(decode(&flipped).is_err(), "byte {at}, bit {bit}");
        }
    }
    for length in 0..bytes.len() {
        assert!(decode(&bytes[..length]).is_err(), "length {length}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(decode(&longer).is_err());
}

#[test]
fn nonsense_with_a_right_checksum_is_refused_without_panic_or_huge_memory() {
    let bytes = bytes_of(&sample());
    let content = &bytes[..bytes.len() - CHECKSUM];
    // Overwrite each aligned and unaligned word of the content by a huge number.
    for at in MAGIC.len()..content.len() - 8 {
        let mut changed = content.to_vec();
        changed[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
        let checksum = blake3::hash(&changed);
        changed.extend(checksum.as_bytes());
        // Values may become others, which a checksum cannot know; lengths may not.
        let _ = decode(&changed);
    }
    let mut newer = content.to_vec();
    newer[8] = 2;
    let checksum = blake3::hash(&newer);
    newer.extend(checksum.as_bytes());
    assert_eq!(decode(&newer), Err(RestartProblem::Version { found: 2 }));
}

#[test]
fn damaged_and_foreign_files_are_passed_over_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    write_restart(folder.path(), 5, &numbered(5)).unwrap();
    let last = write_restart(folder.path(), 6, &numbered(6)).unwrap();
    let bytes = std::fs::read(&last).unwrap();
    std::fs::write(&last, &bytes[..bytes.len() - 3]).unwrap();
    std::fs::write(folder.path().join("state-8.jstsph"), "").unwrap();
    let foreign = folder.path().join("state-7.jstsph");
    std::fs::write(&foreign, "my notes").unwrap();
    std::fs::write(folder.path().join("notes.txt"), "ignored").unwrap();

    let (data, warnings) = read_latest_restart(folder.path()).unwrap();
    assert_eq!(data.header, json!(5));
    let latest = latest_restart(folder.path()).unwrap();
    assert!(latest.ends_with("state-000000000005.jstsph"));
    let problems: Vec<_> = warnings.iter().map(|w| w.problem.clone()).collect();
    let (foreign, damaged) = (RestartProblem::Foreign, RestartProblem::Damaged);
    assert_eq!(problems, [foreign.clone(), foreign, damaged]);
    assert!(
        warnings[1]
            .to_string()
            .ends_with("state-7.jstsph is not a restart file")
    );

    std::fs::remove_file(folder.path().join("state-000000000005.jstsph")).unwrap();
    assert_eq!(latest_restart(folder.path()), None);
    let text = read_latest_restart(folder.path()).unwrap_err().to_string();
    assert!(
        text.contains("not a restart file") && text.contains("checksum"),
        "{text}"
    );
}

#[test]
fn the_two_latest_are_kept_and_an_abandoned_future_is_not() {
    let folder = tempfile::tempdir().unwrap();
    for step in [10, 20, 30, 100] {
        write_restart(folder.path(), step, &numbered(step)).unwrap();
    }
    assert_eq!(steps(folder.path()), [100, 30]);
    // A run continued from step 30 because 100 was damaged.
    write_restart(folder.path(), 40, &numbered(40)).unwrap();
    assert_eq!(steps(folder.path()), [40, 30]);
}

#[test]
fn shapes_and_names_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let array = RestartArray {
        name: "a".to_owned(),
        shape: vec![2, 2],
        values: vec![1.0; 3],
    };
    let mut data = RestartData {
        header: json!(null),
        arrays: vec![array],
    };
    assert!(matches!(
        write_restart(folder.path(), 0, &data),
        Err(OutputError::RestartShape { values: 3, .. })
    ));
    data.arrays[0].shape = vec![3];
    data.arrays.push(data.arrays[0].clone());
    assert!(matches!(
        write_restart(folder.path(), 0, &data),
        Err(OutputError::DuplicateName { .. })
    ));
    assert!(steps(folder.path()).is_empty());
}

#[test]
fn pieces_make_the_file_that_whole_arrays_make() {
    let values: Vec<f64> = (0..3 * PIECE + 30).map(|i| i as f64).collect();
    let data = RestartData {
        header: json!({"a": 1.0}),
        arrays: vec![RestartArray {
            name: "vectors".to_owned(),
            shape: vec![values.len() as u64],
            values: values.clone(),
        }],
    };
    let pieces = || {
        let values = &values;
        RestartPieces::list(
            "vectors".to_owned(),
            values.len() / 3,
            3,
            move |range, out| out.extend_from_slice(&values[3 * range.start..3 * range.end]),
        )
    };
    let folder = tempfile::tempdir().unwrap();
    let whole = write_restart(folder.path(), 1, &data).unwrap();
    let piecewise = write_restart_pieces(folder.path(), 2, &data.header, &[pieces()]).unwrap();
    assert_eq!(
        std::fs::read(whole).unwrap(),
        std::fs::read(piecewise).unwrap()
    );
    assert!(matches!(
        write_restart_pieces(folder.path(), 3, &data.header, &[pieces(), pieces()]),
        Err(OutputError::DuplicateName { .. })
    ));
}
