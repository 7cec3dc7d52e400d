//! The keyboard of the table: what each key does, one after the other as they were pressed.

use egui::{Context, Event, EventFilter, Key, Modifiers, Ui};

use crate::app::{Command, Document};

use super::sheet::Sheet;

/// Rows that a page key moves by.
const PAGE: isize = 20;

/// Keys that came faster than the document could follow, for the next frame.
#[derive(Clone, Debug, Default)]
pub struct Keyboard {
    deferred: Vec<Event>,
    /// The key that ends the editor, once the field has taken what was typed before it.
    ending: Option<(Key, Modifiers)>,
}

impl Keyboard {
    /// Deals with what was pressed while the table has the focus. Call it before anything of the table is drawn; the
    /// editor's field then finds what belongs to it, and [`Self::end_editor`] does the rest.
    pub fn handle(&mut self, ui: &Ui, sheet: &mut Sheet, document: &Document, commands: &mut Vec<Command>) {
        let mut events = std::mem::take(&mut self.deferred);
        let (ours, others): (Vec<Event>, Vec<Event>) =
            ui.input_mut(|input| std::mem::take(&mut input.events)).into_iter().partition(is_of_keyboard);
        events.extend(ours);
        let mut events = events.into_iter();
        let mut kept = others;
        for event in events.by_ref() {
            if let Some(editor) = &sheet.editor {
                // What stands before the key that ends it is for the field.
                if let Some(ending) = ending_key(&event, editor.is_replacing) {
                    self.ending = Some(ending);
                    break;
                }
                kept.push(event);
                continue;
            }
            let num_commands = commands.len();
            if !handle_one(ui.ctx(), sheet, document, &event, commands) {
                kept.push(event);
            }
            if commands.len() > num_commands {
                // What follows is meant for the document as it will be.
                break;
            }
        }
        self.deferred = events.collect();
        if !self.deferred.is_empty() {
            ui.ctx().request_repaint();
        }
        ui.input_mut(|input| input.events = kept);
    }

    /// Does what the key says that ended the editor, once its field was drawn. Answers whether one did.
    pub fn end_editor(&mut self, sheet: &mut Sheet, commands: &mut Vec<Command>) -> bool {
        let Some((key, modifiers)) = self.ending.take() else { return false };
        if key == Key::Escape {
            sheet.editor = None;
            return true;
        }
        sheet.commit(commands);
        match key {
            Key::Enter => sheet.step(if modifiers.shift { -1 } else { 1 }, 0, false),
            Key::Tab => sheet.step(0, if modifiers.shift { -1 } else { 1 }, false),
            Key::ArrowUp => sheet.step(-1, 0, false),
            Key::ArrowDown => sheet.step(1, 0, false),
            Key::ArrowLeft => sheet.step(0, -1, false),
            Key::ArrowRight => sheet.step(0, 1, false),
            _ => {}
        }
        true
    }
}

/// While the table has the focus, Tab, arrows and Escape are its own.
pub fn lock_focus(ctx: &Context, id: egui::Id) {
    let keys = EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: true };
    ctx.memory_mut(|memory| memory.set_focus_lock_filter(id, keys));
}

fn is_of_keyboard(event: &Event) -> bool {
    matches!(event, Event::Text(_) | Event::Key { pressed: true, .. } | Event::Copy | Event::Cut | Event::Paste(_))
}

fn ending_key(event: &Event, is_replacing: bool) -> Option<(Key, Modifiers)> {
    let Event::Key { key, modifiers, .. } = event else { return None };
    let ends = match key {
        Key::Enter | Key::Tab | Key::Escape | Key::ArrowUp | Key::ArrowDown => true,
        Key::ArrowLeft | Key::ArrowRight => is_replacing && modifiers.is_none(),
        _ => false,
    };
    ends.then_some((*key, *modifiers))
}

/// Answers whether the event was one of the table's.
fn handle_one(
    ctx: &Context,
    sheet: &mut Sheet,
    document: &Document,
    event: &Event,
    commands: &mut Vec<Command>,
) -> bool {
    let session = &document.session;
    match event {
        // With shift the blank selects the row; that comes as a key as well.
        Event::Text(text) if text == " " => {
            if !ctx.input(|input| input.modifiers.shift) {
                sheet.toggle(document, commands);
            }
        }
        Event::Text(text) if text.chars().all(|letter| !letter.is_control()) => {
            sheet.choice = None;
            sheet.edit(document, Some(text), commands);
        }
        Event::Copy => ctx.copy_text(sheet.copied(session)),
        Event::Cut => {
            ctx.copy_text(sheet.copied(session));
            sheet.clear(session, commands);
        }
        Event::Paste(text) => sheet.paste(session, text, commands),
        Event::Key { key, modifiers, .. } if sheet.choice.is_some() => {
            return choice_key(sheet, *key, *modifiers, commands);
        }
        Event::Key { key, modifiers, .. } => return handle_key(ctx, sheet, document, *key, *modifiers, commands),
        _ => return false,
    }
    true
}

fn choice_key(sheet: &mut Sheet, key: Key, modifiers: Modifiers, commands: &mut Vec<Command>) -> bool {
    let Some(choice) = &mut sheet.choice else { return false };
    match key {
        Key::ArrowUp => choice.step(-1),
        Key::ArrowDown => choice.step(1),
        Key::Enter => sheet.choose(commands),
        Key::Tab => {
            sheet.choose(commands);
            sheet.step(0, if modifiers.shift { -1 } else { 1 }, false);
        }
        Key::Escape => sheet.choice = None,
        _ => return false,
    }
    true
}

fn handle_key(
    ctx: &Context,
    sheet: &mut Sheet,
    document: &Document,
    key: Key,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> bool {
    let session = &document.session;
    let Modifiers { shift, command, alt, .. } = modifiers;
    let (last_row, last_column) = (sheet.view.rows.len().cast_signed(), sheet.view.columns.len().cast_signed());
    let far = |step: isize, last: isize| if command { step * last } else { step };
    match key {
        Key::ArrowUp | Key::ArrowDown if alt => sheet.shift(session, key == Key::ArrowUp, commands),
        Key::ArrowUp => sheet.step(far(-1, last_row), 0, shift),
        Key::ArrowDown => sheet.step(far(1, last_row), 0, shift),
        Key::ArrowLeft => sheet.step(0, far(-1, last_column), shift),
        Key::ArrowRight => sheet.step(0, far(1, last_column), shift),
        Key::PageUp => sheet.step(-PAGE, 0, shift),
        Key::PageDown => sheet.step(PAGE, 0, shift),
        Key::Home => sheet.step(if command { -last_row } else { 0 }, -last_column, shift),
        Key::End => sheet.step(if command { last_row } else { 0 }, last_column, shift),
        Key::Enter if modifiers.is_none() => sheet.edit(document, None, commands),
        Key::Enter if shift => sheet.step(-1, 0, false),
        Key::F2 => sheet.edit(document, None, commands),
        Key::Tab => sheet.step(0, if shift { -1 } else { 1 }, false),
        Key::Escape => {
            if sheet.cursor.is_single() {
                ctx.memory_mut(|memory| {
                    if let Some(id) = memory.focused() {
                        memory.surrender_focus(id);
                    }
                });
            } else {
                sheet.step(0, 0, false);
            }
        }
        Key::Delete if command => sheet.remove(commands),
        Key::Delete | Key::Backspace if sheet.cursor.has_whole_rows => sheet.remove(commands),
        Key::Delete | Key::Backspace => sheet.clear(session, commands),
        Key::Insert if modifiers.is_none() => sheet.add(session, commands),
        Key::N if command && shift => sheet.add(session, commands),
        Key::D if command && shift => sheet.duplicate(commands),
        Key::D if command => sheet.fill(session, commands),
        Key::A if command => sheet.cursor.select_all(sheet.view.rows.len(), sheet.view.columns.len()),
        Key::Space if shift => sheet.cursor.extend_rows_to(sheet.cursor.row),
        _ => return false,
    }
    true
}
