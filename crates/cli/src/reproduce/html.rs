//! The page as one HTML file that needs no other.

use std::path::Path;

use super::judge::Verdict;
use super::page::{Block, anchor};

const STYLE: &str = "\
body{font:16px/1.5 system-ui,sans-serif;max-width:66rem;margin:2rem auto;padding:0 1rem;color:#222}\
h1,h2,h3{line-height:1.2}h2{margin-top:2.5rem;border-bottom:1px solid #ccc}\
table{border-collapse:collapse;font-size:.9rem;margin:1rem 0;display:block;overflow-x:auto}\
th,td{padding:.25rem .6rem;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}\
th{background:#f4f4f4}code{background:#f4f4f4;padding:0 .2em;font-size:.92em}\
figure{margin:1.5rem 0}img{max-width:100%}figcaption{font-size:.9rem;color:#555}\
.met{color:#0a6b3d;font-weight:600}.close{color:#7a5a00;font-weight:600}\
.differs,.failed{color:#b3261e;font-weight:600}.shown,.not-run{color:#666}";

/// Writes blocks. `picture` gives the bytes of a PNG file; one that it does not have is left out.
pub(super) fn text(
    title: &str,
    blocks: &[Block],
    picture: impl Fn(&Path) -> Option<Vec<u8>>,
) -> String {
    let body: Vec<String> = blocks.iter().map(|part| block(part, &picture)).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n{}\n</body>\n</html>\n",
        escaped(title),
        body.join("\n")
    )
}

fn block(block: &Block, picture: &impl Fn(&Path) -> Option<Vec<u8>>) -> String {
    match block {
        Block::Heading(level, text) => {
            format!(
                "<h{level} id=\"{}\">{}</h{level}>",
                anchor(text),
                inline(text)
            )
        }
        Block::Text(text) => format!("<p>{}</p>", inline(text)),
        Block::Table { head, rows } => {
            let head: String = head
                .iter()
                .map(|cell| format!("<th>{}</th>", inline(cell)))
                .collect();
            let rows: String = rows.iter().map(|row| table_row(row)).collect();
            format!("<table>\n<tr>{head}</tr>\n{rows}</table>")
        }
        Block::Picture { file, caption } => match picture(Path::new(file)) {
            Some(bytes) => format!(
                "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>",
                escaped(caption),
                base64(&bytes)
            ),
            None => String::new(),
        },
    }
}

fn table_row(row: &[String]) -> String {
    let cells = row.iter().map(|cell| {
        let is = |verdict: &&Verdict| cell.split(':').next() == Some(verdict.text());
        match Verdict::ALL.iter().find(is) {
            Some(verdict) => format!(
                "<td class=\"{}\">{}</td>",
                verdict.text().replace(' ', "-"),
                inline(cell)
            ),
            None => format!("<td>{}</td>", inline(cell)),
        }
    });
    format!("<tr>{}</tr>\n", cells.collect::<String>())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// `code`, **bold** and [links](target) of a text; a mark without its partner stays as it is.
fn inline(text: &str) -> String {
    let mut html = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', '*', '[']) {
        html += &escaped(&rest[..at]);
        rest = &rest[at..];
        let found = between(rest, "`", "`")
            .map(|(code, after)| (format!("<code>{}</code>", escaped(code)), after))
            .or_else(|| {
                let (bold, after) = between(rest, "**", "**")?;
                Some((format!("<strong>{}</strong>", inline(bold)), after))
            })
            .or_else(|| {
                let (name, after) = between(rest, "[", "](")?;
                let (target, after) = after.split_once(')')?;
                let link = format!("<a href=\"{}\">{}</a>", escaped(target), inline(name));
                Some((link, after))
            });
        match found {
            Some((marked, after)) => {
                html += &marked;
                rest = after;
            }
            None => {
                html += &escaped(&rest[..1]);
                rest = &rest[1..];
            }
        }
    }
    html + &escaped(rest)
}

/// What stands between a mark at the beginning and the next other one, and what follows.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Option<(&'a str, &'a str)> {
    text.strip_prefix(open)?.split_once(close)
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let index = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if digit <= group.len() {
                char::from(DIGITS[index])
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xff, 0xef]), "/+8=");
    }

    #[test]
    fn marks_become_elements_and_the_rest_is_escaped() {
        assert_eq!(
            inline("a < b, `c[i]`, **d `e`** and [f](#g) * [h"),
            "a &lt; b, <code>c[i]</code>, <strong>d <code>e</code></strong> and \
             <a href=\"#g\">f</a> * [h"
        );
    }

    #[test]
    fn verdicts_are_coloured_and_pictures_embedded() {
        let blocks = [
            Block::Table {
                head: vec!["x".to_owned()],
                rows: vec![vec!["1".to_owned(), "not run: later".to_owned()]],
            },
            Block::Picture {
                file: "a.png".to_owned(),
                caption: "A".to_owned(),
            },
            Block::Picture {
                file: "b.png".to_owned(),
                caption: "B".to_owned(),
            },
        ];
        let page = text("T", &blocks, |path| {
            (path == Path::new("a.png")).then(|| b"foo".to_vec())
        });
        assert!(page.contains("<td>1</td><td class=\"not-run\">not run: later</td>"));
        assert!(page.contains("src=\"data:image/png;base64,Zm9v\""));
        assert!(!page.contains(">B<"));
    }
}
