//! The page as Markdown.

use super::page::Block;

/// Writes blocks; pictures are named by the file beside the page.
pub(super) fn text(blocks: &[Block]) -> String {
    let parts: Vec<String> = blocks.iter().map(block).collect();
    parts.join("\n\n") + "\n"
}

fn block(block: &Block) -> String {
    match block {
        Block::Heading(level, text) => format!("{} {text}", "#".repeat(usize::from(*level))),
        Block::Text(text) => text.clone(),
        Block::Table { head, rows } => {
            let line = |cells: &[String]| {
                let cells: Vec<String> =
                    cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
                format!("| {} |", cells.join(" | "))
            };
            let rule = format!("|{}", "---|".repeat(head.len()));
            let rows: Vec<String> = rows.iter().map(|row| line(row)).collect();
            format!("{}\n{rule}\n{}", line(head), rows.join("\n"))
        }
        Block::Picture { file, caption } => format!("![{caption}]({file})\n\n{caption}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_become_markdown() {
        let blocks = [
            Block::Heading(2, "Head".to_owned()),
            Block::Table {
                head: vec!["a".to_owned(), "b".to_owned()],
                rows: vec![vec!["1".to_owned(), "x|y".to_owned()]],
            },
            Block::Picture {
                file: "p/a.png".to_owned(),
                caption: "A bar".to_owned(),
            },
        ];
        assert_eq!(
            text(&blocks),
            "## Head\n\n| a | b |\n|---|---|\n| 1 | x\\|y |\n\n![A bar](p/a.png)\n\nA bar\n"
        );
    }
}
