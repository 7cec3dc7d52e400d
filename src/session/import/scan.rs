//! Reading along a robot program: words, numbers and brackets, with line and column.

use crate::sheet::text::number;

/// A place in a program's text.
#[derive(Clone, Debug)]
pub(super) struct Scanner<'t> {
    text: &'t str,
    at: usize,
    /// What begins a comment that runs to the end of the line.
    comment: &'static str,
    line: usize,
    column: usize,
    counted: usize,
}

impl<'t> Scanner<'t> {
    pub fn new(text: &'t str, comment: &'static str) -> Self {
        Self { text, at: 0, comment, line: 1, column: 1, counted: 0 }
    }

    pub fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    pub const fn at(&self) -> usize {
        self.at
    }

    pub const fn jump(&mut self, at: usize) {
        self.at = at;
    }

    pub fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    pub fn bump(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.at += c.len_utf8();
        Some(c)
    }

    /// Line and column, from 1, of a byte; bytes are asked for in ascending order, so that the text is counted once.
    pub fn place(&mut self, byte: usize) -> (usize, usize) {
        if byte < self.counted {
            (self.line, self.column, self.counted) = (1, 1, 0);
        }
        let bytes = self.text.as_bytes();
        for idx in self.counted..byte.min(bytes.len()) {
            let is_line_end = bytes[idx] == b'\n' || (bytes[idx] == b'\r' && bytes.get(idx + 1) != Some(&b'\n'));
            if is_line_end {
                (self.line, self.column) = (self.line + 1, 1);
            } else if bytes[idx] & 0xc0 != 0x80 {
                // The first byte of a character.
                self.column += 1;
            }
        }
        self.counted = byte;
        (self.line, self.column)
    }

    /// Passes over blanks, line ends and comments.
    pub fn skip_blanks(&mut self) {
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start();
            self.at += rest.len() - trimmed.len();
            if self.comment.is_empty() || !trimmed.starts_with(self.comment) {
                return;
            }
            self.at += trimmed.find(['\n', '\r']).unwrap_or(trimmed.len());
        }
    }

    /// Passes over this character, if it is next.
    pub fn eat(&mut self, wanted: char) -> bool {
        self.skip_blanks();
        let is_next = self.peek() == Some(wanted);
        if is_next {
            self.at += wanted.len_utf8();
        }
        is_next
    }

    /// The word that is next; empty if there is none.
    pub fn word(&mut self) -> &'t str {
        self.skip_blanks();
        let rest = self.rest();
        let end = rest.find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '$'))).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// The number that is next; stays where it is if there is none.
    pub fn number(&mut self) -> Option<f64> {
        self.skip_blanks();
        let rest = self.rest();
        let is_part = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
        let end = rest.find(|c: char| !is_part(c)).unwrap_or(rest.len());
        let value = number(&rest[..end], false)?;
        self.at += end;
        Some(value)
    }

    /// Numbers between brackets, exactly as many; stays at the first thing that is otherwise.
    pub fn bracketed<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        if !self.eat('[') {
            return None;
        }
        for (idx, value) in numbers.iter_mut().enumerate() {
            if idx > 0 && !self.eat(',') {
                return None;
            }
            *value = self.number()?;
        }
        self.eat(']').then_some(numbers)
    }

    /// What stands here, for a message: up to the end of the line.
    pub fn found(&self) -> &'t str {
        const MAX_CHARS: usize = 60;
        let rest = self.rest();
        let mut chars = rest.char_indices().take(MAX_CHARS);
        let end = chars.find(|(_, c)| matches!(c, '\n' | '\r')).map(|(at, _)| at);
        let limit = rest.char_indices().nth(MAX_CHARS).map_or(rest.len(), |(at, _)| at);
        rest[..end.unwrap_or(limit)].trim()
    }

    /// Goes to the next word of a program, past strings, comments and numbers; `None` at the end.
    pub fn next_word(&mut self) -> Option<&'t str> {
        loop {
            self.skip_blanks();
            match self.peek()? {
                '"' => {
                    self.bump();
                    let rest = self.rest();
                    let end = rest.find(['"', '\n', '\r']).unwrap_or(rest.len());
                    self.at += end;
                    if self.peek() == Some('"') {
                        self.bump();
                    }
                }
                c if c.is_alphanumeric() || matches!(c, '_' | '$') => return Some(self.word()),
                _ => {
                    self.bump();
                }
            }
        }
    }
}
