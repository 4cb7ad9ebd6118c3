//! Invalid programs are rejected with the reason.

use super::program;
use crate::Module;

fn refusal(text: &str) -> String {
    Module::load(&wat::parse_str(text).expect("a module")).expect_err("it is refused").to_string()
}

/// Proves: AMK-APSF-02, AMK-APSF-17, AMK-APSF-18, AMK-APSF-19, AMK-APSF-20, AMK-APSF-21, AMK-APSF-22, AMK-APSF-23, AMK-APSF-24,
/// AMK-APSF-25, AMK-APSF-26, AMK-APSF-27, AMK-APSF-28
#[test]
fn whatever_it_would_call_outside_is_refused_by_its_name() {
    let forbidden = ["SI", "SV", "SE", "SS", "SA", "R", "SPA", "SPB", "E", "STP", "STS"];
    for name in forbidden {
        let text = program("(func (export \"cycle\"))")
            .replace("(module", &format!("(module (import \"ps\" \"{name}\" (func (param i32)))"));
        let sentence = refusal(&text);
        assert!(sentence.starts_with(&format!("it imports `{name}` of `ps`; a program has no imports")), "{sentence}");
    }
}

#[test]
fn a_module_without_entry_or_image_is_refused() {
    assert_eq!(refusal(&program("")), "it exports no function `cycle`");
    assert_eq!(
        refusal(&program("(func (export \"cycle\") (param i32))")),
        "its function `cycle` has parameters or results; it takes and gives none"
    );
    assert_eq!(refusal(&program("(global (export \"cycle\") i32 (i32.const 1))")), "its export `cycle` is no function");
    let image =
        |global: &str, data: &str| refusal(&format!("(module (memory 1) {global} {data} (func (export \"cycle\")))"));
    assert_eq!(image("", ""), "it exports no `image`, the address of its image");
    let at = |at: u32| format!("(global (export \"image\") i32 (i32.const {at}))");
    assert_eq!(image(&at(12), ""), "its image is at 12; an address above 0 that 8 divides is needed");
    assert_eq!(image(&at(0), ""), "its image is at 0; an address above 0 that 8 divides is needed");
    assert_eq!(image(&at(65536), ""), "its image is outside its memory");
    assert_eq!(image(&at(16), ""), "the first word of its image, its size, is 0; 944 to 17328 bytes are possible");
    // 943 bytes: one less than the slot writes.
    assert_eq!(
        image(&at(16), "(data (i32.const 16) \"\\af\\03\")"),
        "the first word of its image, its size, is 943; 944 to 17328 bytes are possible"
    );
    assert_eq!(
        image(&at(64600), "(data (i32.const 64600) \"\\b0\\03\")"),
        "its image ends at 65544, behind its memory of 65536 bytes"
    );
    assert_eq!(image("(global (export \"image\") (mut i32) (i32.const 16))", ""), "its export `image` is no constant");
    assert_eq!(refusal("(module (func (export \"cycle\")))"), "it has no memory of its own, where its image would be");
}

#[test]
fn machine_dependent_feature_is_refused() {
    let start = program("(func (export \"cycle\")) (func $first) (start $first)");
    assert_eq!(refusal(&start), "it has a start function; a program begins in `cycle`, with command 1");
    let pages = "(module (memory 17) (func (export \"cycle\")))";
    assert!(
        refusal(pages).starts_with("its memory has 17 pages of 64 KiB; at most 16 are possible (rustc: -C link-arg=")
    );
    let passive = program("(func (export \"cycle\")) (data \"abc\")");
    assert!(refusal(&passive).starts_with("it fills its memory later on (passive data)"));
    let table = program("(table 2 funcref) (func (export \"cycle\") (table.set 0 (i32.const 0) (ref.null func)))");
    let sentence = refusal(&table);
    assert!(
        sentence.starts_with("function 0: it uses ") && sentence.contains(", which no program may use (byte "),
        "{sentence}"
    );
    let vector = program("(func (export \"cycle\") (drop (v128.const i64x2 0 0)))");
    assert!(refusal(&vector).starts_with("it is no valid WebAssembly of this version at byte "));
    let long = program("(func (export \"cycle\")) (data (i32.const 65534) \"abc\")");
    assert_eq!(refusal(&long), "its memory is shorter than what fills it");
    let locals = program(&format!("(func (export \"cycle\") (local {}))", "i32 ".repeat(4097)));
    assert_eq!(refusal(&locals), "function 0: it has 4097 locals; at most 4096 are possible");
}

/// A module that would need gigabytes or minutes is rejected before that.
#[test]
fn a_hostile_module_is_refused_soon() {
    let begun = |text: &str| refusal(&program(text));
    let piles = format!("(func (export \"cycle\") {} unreachable)", "i32.const 0 ".repeat(1025));
    assert!(begun(&piles).starts_with("function 0 has more than 1024 operands at once (byte "));
    let results = format!("(func $f (result {}) unreachable)", "i64 ".repeat(900));
    let calls = format!("{results} (func (export \"cycle\") {} unreachable)", "call $f ".repeat(100_000));
    assert!(begun(&calls).starts_with("function 1 has more than 1024 operands at once (byte "));
    let tables = format!("{} (func (export \"cycle\"))", "(table 1 funcref) ".repeat(17));
    assert_eq!(begun(&tables), "it has more than 16 tables");
    let import = format!("(module (import \"{0}\" \"{0}\" (func)))", "x".repeat(50_000));
    assert!(refusal(&import).len() < 400);
    // Blocks and locals with the maximum number of operands.
    let operands = "i32.const 0 ".repeat(1000);
    let blocks = "block end i32.const 0 local.set 0 ".repeat(50_000);
    let text = program(&format!("(func (export \"cycle\") (local i32) {operands} {blocks} unreachable)"));
    Module::load(&wat::parse_str(text).unwrap()).expect("it is taken");
}

#[test]
fn bytes_that_are_no_module_are_refused() {
    let refused = |bytes: &[u8]| Module::load(bytes).unwrap_err().to_string();
    assert_eq!(refused(b""), "it is no WebAssembly: its first four bytes are others than \\0asm");
    assert_eq!(refused(b"cycle"), "it is no WebAssembly: its first four bytes are others than \\0asm");
    assert!(refused(b"\0asm\x01\0\0").starts_with("it is no valid WebAssembly of this version at byte "));
    assert_eq!(refused(b"\0asm\x0d\0\x01\0"), "it is a component; a core module is needed");
    assert_eq!(refused(&vec![0; (1 << 20) + 1]), "it has 1048577 bytes; at most 1048576 are possible");
}
