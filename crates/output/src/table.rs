//! Tables of numbers as comma-separated text: one writer that appends, one reader.

use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{TableProblem, require_finite, require_length};
use crate::{OutputError, atomic_write};

/// A table read into memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, each with one entry per column.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// Values of the column `name` from top to bottom; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }
}

/// Reads a comma-separated table: a header line of names, then rows of numbers.
///
/// Numbers written by [`TableWriter`] come back bit for bit, an empty entry as NaN. Blank lines are skipped.
///
/// # Errors
/// [`OutputError::Io`] and [`OutputError::Table`] with the line and what is wrong with it.
pub fn read_table(path: &Path) -> Result<Table, OutputError> {
    let text = std::fs::read_to_string(path).map_err(OutputError::io("read", path))?;
    parse_table(path, &text)
}

fn parse_table(path: &Path, text: &str) -> Result<Table, OutputError> {
    let fail = |line: usize, problem| OutputError::Table {
        path: path.to_path_buf(),
        line,
        problem,
    };
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let (_, header) = lines
        .next()
        .ok_or_else(|| fail(1, TableProblem::NoHeader))?;
    let columns: Vec<String> = header
        .split(',')
        .map(|name| name.trim().to_owned())
        .collect();
    let mut rows = Vec::new();
    for (index, line) in lines {
        let entries: Vec<&str> = line.split(',').map(str::trim).collect();
        if entries.len() != columns.len() {
            let problem = TableProblem::Entries {
                found: entries.len(),
                expected: columns.len(),
            };
            return Err(fail(index + 1, problem));
        }
        let mut row = Vec::with_capacity(columns.len());
        for (column, text) in columns.iter().zip(entries) {
            let problem = || TableProblem::Number {
                column: column.clone(),
                text: text.to_owned(),
            };
            row.push(if text.is_empty() {
                f64::NAN
            } else {
                text.parse().map_err(|_| fail(index + 1, problem()))?
            });
        }
        rows.push(row);
    }
    Ok(Table { columns, rows })
}

/// Appends rows to a comma-separated table; every row reaches the system before the call returns.
///
/// Numbers are the shortest text that reads back to the same bits.
#[derive(Debug)]
pub struct TableWriter {
    path: PathBuf,
    columns: Vec<String>,
    file: File,
    /// Length of the file, bytes: header and whole rows.
    length: u64,
}

impl TableWriter {
    /// Starts a table, replacing an existing file. `columns` are written as the header line.
    ///
    /// # Errors
    /// [`OutputError::DuplicateName`], [`OutputError::Io`].
    pub fn create(path: &Path, columns: Vec<String>) -> Result<Self, OutputError> {
        let mut seen = HashSet::new();
        if let Some(name) = columns.iter().find(|name| !seen.insert(name.as_str())) {
            return Err(OutputError::DuplicateName { name: name.clone() });
        }
        let header = columns.join(",");
        atomic_write(path, |writer| writeln!(writer, "{header}"))?;
        Self::append_to(path, columns)
    }

    /// Continues a table whose first column is a time: rows later than `time` (s), and a last line
    /// that a crash left incomplete, are removed. Starts a new table if there is no file.
    ///
    /// # Errors
    /// [`OutputError::Io`], [`OutputError::Table`] if the columns differ or a kept line is damaged.
    pub fn resume(path: &Path, columns: Vec<String>, time: f64) -> Result<Self, OutputError> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Self::create(path, columns);
            }
            Err(error) => return Err(OutputError::io("read", path)(error)),
        };
        let complete = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let table = parse_table(path, complete)?;
        if table.columns != columns {
            return Err(OutputError::Table {
                path: path.to_path_buf(),
                line: 1,
                problem: TableProblem::Header {
                    found: table.columns.join(","),
                    expected: columns.join(","),
                },
            });
        }
        let kept = table.rows.iter().filter(|row| row[0] <= time);
        atomic_write(path, |writer| {
            writeln!(writer, "{}", columns.join(","))?;
            kept.into_iter()
                .try_for_each(|row| writer.write_all(line(row).as_bytes()))
        })?;
        Self::append_to(path, columns)
    }

    fn append_to(path: &Path, columns: Vec<String>) -> Result<Self, OutputError> {
        let file = OpenOptions::new()
            .append(true)
            .open(path)
            .map_err(OutputError::io("open", path))?;
        let length = file
            .metadata()
            .map_err(OutputError::io("open", path))?
            .len();
        Ok(Self {
            path: path.to_path_buf(),
            columns,
            file,
            length,
        })
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Appends one row, with one finite value per column.
    ///
    /// # Errors
    /// [`OutputError::FieldLength`], [`OutputError::NotFinite`] naming the column,
    /// [`OutputError::Io`].
    pub fn append(&mut self, row: &[f64]) -> Result<(), OutputError> {
        self.append_with_gaps(row, row.len())
    }

    /// Appends one row whose entries from index `required` on may be NaN, "no value here": such an
    /// entry is left empty, and [`read_table`] returns it as NaN.
    ///
    /// # Errors
    /// As [`Self::append`]; an infinite entry is refused everywhere.
    pub fn append_with_gaps(&mut self, row: &[f64], required: usize) -> Result<(), OutputError> {
        require_length("row", row.len(), self.columns.len())?;
        for (index, (column, &value)) in self.columns.iter().zip(row).enumerate() {
            if index >= required && value.is_nan() {
                continue;
            }
            require_finite(column, [value]).map_err(|_| OutputError::NotFinite {
                field: column.clone(),
                index,
                value,
            })?;
        }
        // One call for the whole line: a reader never sees half a number of a running simulation.
        let line = line(row);
        if let Err(error) = self.file.write_all(line.as_bytes()) {
            // A full disk may have taken a part of the line. If cutting it off fails too, the
            // table is cut when the run is resumed.
            let _ = self.file.set_len(self.length);
            return Err(OutputError::io("append to", &self.path)(error));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Waits until all rows are on the disk, where not even a power failure loses them.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn sync(&self) -> Result<(), OutputError> {
        self.syncing()?()
    }

    /// What waits, on any thread, until the rows written so far are on the disk.
    ///
    /// # Errors
    /// [`OutputError::Io`], here and when it waits.
    pub fn syncing(
        &self,
    ) -> Result<impl FnOnce() -> Result<(), OutputError> + Send + 'static, OutputError> {
        let path = self.path.clone();
        let file = self.file.try_clone();
        let file = file.map_err(OutputError::io("write", &path))?;
        Ok(move || file.sync_data().map_err(OutputError::io("write", &path)))
    }
}

fn line(row: &[f64]) -> String {
    let cell = |value: f64| {
        if value.is_nan() {
            String::new()
        } else {
            shortest(value)
        }
    };
    let numbers: Vec<String> = row.iter().map(|&value| cell(value)).collect();
    numbers.join(",") + "\n"
}

/// The shortest text that reads back to the same bits; exponents for very large and small values.
pub(crate) fn shortest(value: f64) -> String {
    let text = format!("{value:?}");
    match text.strip_suffix(".0") {
        Some(integer) => integer.to_owned(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(columns: &[&str]) -> Vec<String> {
        columns.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn numbers_come_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let row = [0.1 + 0.2, -0.0, 5e-324, f64::MAX, 12.0, 1e22];
        let mut writer =
            TableWriter::create(&path, names(&["time", "b", "c", "d", "e", "f"])).unwrap();
        writer.append(&row).unwrap();
        let table = read_table(&path).unwrap();
        let bits = |row: &[f64]| row.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&table.rows[0]), bits(&row));
        assert_eq!(table.column("e"), Some(vec![12.0]));
        assert_eq!(table.column("g"), None);
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            text,
            "time,b,c,d,e,f\n0.30000000000000004,-0,5e-324,1.7976931348623157e308,12,1e22\n"
        );
    }

    #[test]
    fn resuming_removes_later_rows_and_a_torn_last_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let columns = names(&["time", "x"]);
        let mut writer = TableWriter::create(&path, columns.clone()).unwrap();
        for i in 0..4 {
            writer.append(&[f64::from(i) * 0.1, 1.0]).unwrap();
        }
        std::fs::write(&path, std::fs::read_to_string(&path).unwrap() + "0.4,1.23").unwrap();
        let mut writer = TableWriter::resume(&path, columns, 0.1).unwrap();
        writer.append(&[0.15, 2.0]).unwrap();
        let table = read_table(&path).unwrap();
        assert_eq!(table.column("time"), Some(vec![0.0, 0.1, 0.15]));
    }

    #[test]
    fn resuming_with_other_columns_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        TableWriter::create(&path, names(&["time", "x"])).unwrap();
        let error = TableWriter::resume(&path, names(&["time", "y"]), 1.0).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("`time,x`") && text.contains("`time,y`"),
            "{text}"
        );
    }

    #[test]
    fn bad_rows_are_refused_and_leave_the_file_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut writer = TableWriter::create(&path, names(&["time", "x"])).unwrap();
        let error = writer.append(&[0.0, f64::INFINITY]).unwrap_err();
        assert!(
            matches!(&error, OutputError::NotFinite { field, index: 1, .. } if field == "x"),
            "{error}"
        );
        assert!(matches!(
            writer.append(&[0.0]),
            Err(OutputError::FieldLength {
                found: 1,
                expected: 2,
                ..
            })
        ));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time,x\n");
        let twice = TableWriter::create(&path, names(&["x", "x"]));
        assert!(matches!(twice, Err(OutputError::DuplicateName { .. })));
    }

    #[test]
    fn a_damaged_table_names_line_and_column() {
        let parse = |text| {
            parse_table(Path::new("a.csv"), text)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            parse("time,x\n0,1\n1,oops\n"),
            "a.csv, line 3: column `x`: `oops` is not a number"
        );
        assert_eq!(
            parse("time,x\n\n0,1,2\n"),
            "a.csv, line 3: 3 entries, the header has 2"
        );
        assert_eq!(parse("\n"), "a.csv, line 1: the header line is missing");
    }
}
