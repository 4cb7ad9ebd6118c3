//! Reads the pages of the documentation: their commands and their code blocks.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Returns the root folder of the repository.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").to_owned()
}

/// One page.
pub(crate) struct Page {
    /// Path from the root of the repository.
    pub(crate) name: String,
    text: String,
}

/// A command on a page.
pub(crate) struct Quote {
    /// Page and line.
    pub(crate) place: String,
    pub(crate) page: String,
    /// On one line, without the prompt; a comment may follow it.
    pub(crate) text: String,
    /// True for a line of a code block; false for code within a sentence.
    pub(crate) is_block: bool,
}

/// A fenced block.
pub(crate) struct Block {
    /// Page and line.
    pub(crate) place: String,
    pub(crate) language: String,
    pub(crate) text: String,
}

/// Reads README.md and all pages of docs, without docs/spec.
pub(crate) fn read() -> Vec<Page> {
    let entries = fs::read_dir(root().join("docs")).expect("docs");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"));
    let mut names: Vec<String> =
        names.filter(|name| name.ends_with(".md")).map(|name| format!("docs/{name}")).collect();
    names.push("README.md".to_owned());
    names.sort();
    let page = |name: String| {
        let text = fs::read_to_string(root().join(&name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        Page { name, text }
    };
    names.into_iter().map(page).collect()
}

impl Page {
    /// Returns all code of the page, in its order: lines of code blocks, and code within sentences.
    pub(crate) fn code(&self) -> Vec<Quote> {
        let (mut found, mut prose, mut is_fenced) = (Vec::new(), Vec::new(), false);
        let mut lines = self.text.lines().enumerate();
        while let Some((number, line)) = lines.next() {
            let trimmed = line.trim();
            let is_fence = trimmed.starts_with("```");
            let is_block = is_fenced || line.starts_with("    ");
            if is_fence || is_block || trimmed.is_empty() || trimmed.starts_with('|') {
                self.sentences(&mut prose, &mut found);
            }
            if is_fence {
                is_fenced = !is_fenced;
            } else if is_block {
                let mut text = without_prompt(trimmed).to_owned();
                while let Some(begun) = text.strip_suffix('\\') {
                    let next = lines.next().map_or("", |(_, next)| next.trim());
                    text = format!("{begun}{next}");
                }
                found.push(self.quote(number, text, true));
            } else {
                prose.push((number, line));
            }
        }
        self.sentences(&mut prose, &mut found);
        found
    }

    /// Extracts the code between backticks from a paragraph.
    fn sentences(&self, prose: &mut Vec<(usize, &str)>, found: &mut Vec<Quote>) {
        let number = prose.first().map_or(0, |(number, _)| *number);
        let text = prose.drain(..).map(|(_, line)| line).collect::<Vec<_>>().join(" ");
        for code in text.split('`').skip(1).step_by(2) {
            let text = code.split_whitespace().collect::<Vec<_>>().join(" ");
            found.push(self.quote(number, text, false));
        }
    }

    fn quote(&self, number: usize, text: String, is_block: bool) -> Quote {
        Quote { place: self.place(number), page: self.name.clone(), text, is_block }
    }

    fn place(&self, number: usize) -> String {
        format!("{}:{}", self.name, number + 1)
    }

    /// Returns the commands that begin with `prefix`.
    pub(crate) fn commands(&self, prefix: &str) -> Vec<Quote> {
        self.code().into_iter().filter(|quote| quote.text.starts_with(prefix)).collect()
    }

    /// Returns the fenced blocks.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        let (mut found, mut open): (Vec<Block>, Option<Block>) = (Vec::new(), None);
        for (number, line) in self.text.lines().enumerate() {
            match (line.trim().strip_prefix("```"), open.take()) {
                (Some(_), Some(block)) => found.push(block),
                (Some(language), None) => {
                    let (place, language) = (self.place(number), language.to_owned());
                    open = Some(Block { place, language, text: String::new() });
                }
                (None, Some(mut block)) => {
                    block.text += line;
                    block.text.push('\n');
                    open = Some(block);
                }
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a block has no end", self.name);
        found
    }

    /// Returns its text on one line.
    pub(crate) fn one_line(&self) -> String {
        self.text.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// Returns the command of a line in a shell, or of a step in CI.
fn without_prompt(line: &str) -> &str {
    line.strip_prefix("$ ").or_else(|| line.strip_prefix("- run: ")).unwrap_or(line)
}

/// Splits a command into words as a shell does, up to a comment.
pub(crate) fn words(text: &str) -> Vec<String> {
    let (mut words, mut word, mut quote): (Vec<String>, Option<String>, Option<char>) = (Vec::new(), None, None);
    for c in text.chars() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (None, '\'' | '"') => {
                quote = Some(c);
                word = Some(word.unwrap_or_default());
            }
            (None, '#') if word.is_none() => break,
            (None, c) if c.is_whitespace() => words.extend(word.take()),
            _ => word.get_or_insert_with(String::new).push(c),
        }
    }
    words.extend(word);
    words
}
