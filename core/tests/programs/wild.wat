;; A program that traps, runs out of fuel and counts on, as its source says. Its image is at 16, with 16 bytes of its own.
(module
  (memory 1)
  (global (export "image") i32 (i32.const 16))
  (data (i32.const 16) "\c0\03\00\00")
  (global $calls (mut i32) (i32.const 0))
  (func $mean (param $a f64) (param $b f64) (result f64)
    (f64.sqrt (f64.abs (f64.mul (local.get $a) (f64.div (local.get $b) (f64.const 3))))))
  (func (export "cycle") (local $way i32) (local $n i32)
    (global.set $calls (i32.add (global.get $calls) (i32.const 1)))
    (local.set $way (i32.and (i32.wrap_i64 (i64.load (i32.const 24))) (i32.const 127)))
    (if (i32.eq (i32.load8_u (i32.const 20)) (i32.const 255)) (then
      (if (i32.eq (local.get $way) (i32.const 77)) (then (drop (i32.div_u (i32.const 1) (i32.const 0)))))
      (if (i32.eq (local.get $way) (i32.const 33)) (then (loop $again (br $again))))))
    (loop $taps
      (f64.store (i32.const 960) (f64.add (f64.load (i32.const 960))
        (call $mean (f64.convert_i32_s (local.get $n)) (f64.convert_i64_s (i64.load (i32.const 24))))))
      (br_if $taps (i32.lt_u (local.tee $n (i32.add (local.get $n) (i32.const 1))) (local.get $way))))
    ;; The high byte, which a NaN has like no other number.
    (i32.store8 (i32.const 22) (i32.load8_u (i32.const 967)))
    (i64.store (i32.const 184) (i64.extend_i32_u (global.get $calls)))
    (i64.store (i32.const 40) (i64.add (i64.trunc_sat_f64_s (f64.load (i32.const 960)))
      (i64.add (i64.load (i32.const 32)) (i64.extend_i32_u (global.get $calls)))))))
