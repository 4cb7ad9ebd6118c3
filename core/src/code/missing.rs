//! What does not exist yet, or not there.

use super::Code;

/// What is missing for a value, behind its name.
pub fn not_built_here(code: Code) -> &'static str {
    match code {
        Code::LOOP_IN_DRIVE => {
            "inverts the position loop, which a drive with interface position closes itself; 1, 11, -1 and -11 are allowed"
        }
        Code::NO_VELOCITY_LOOP => {
            "inverts one loop and not the other, and both have one encoder; 1, 2, 11, 22 and their negatives are allowed"
        }
        Code::VELOCITY_ENCODER_OTHER => {
            "names no encoder that its velocity loop reads: -1, that of the position loop, and the number of the axis itself, the encoder of its drive, are allowed"
        }
        Code::VELOCITY_ENCODER_TURN => {
            "gives no turn of the encoder that ampencno names; 1 to 1073741823 increments are allowed"
        }
        Code::VELOCITY_ENCODER_TWO_DRIVES => "names one encoder for an axis that two drives carry; -1 is allowed",
        Code::ANALOG_FULL => "exceeds what its drive does at 10 V; full_velocity or full_effort at most is allowed",
        Code::ANALOG_COASTS => {
            "leaves the axis to the stop of its drive, and one that takes a torque as a voltage coasts; 0, 1, 2, 3 and 5 are allowed"
        }
        Code::ANALOG_SILENT => {
            "asks for what no drive that is given a voltage tells; an entry of encoders as feedback (encodertype 0), ampencno -1 and torque_constant 0 are allowed"
        }
        Code::LOOP_PERIOD => {
            "is no whole number of cycles, and the position loop runs in cycles; a period that the cycle divides is allowed"
        }
        Code::EFFORT_MISSING => {
            "is missing for an axis with interface torque or voltage; an effort above 0 is expected"
        }
        Code::NO_POWER_STAGE => {
            "asks for a voltage, and a drive with interface torque closes its current loop itself; 0 and 2 are allowed"
        }
        Code::NO_DAMPING => {
            "damps nothing, and with ampmode 2 the position loop makes the effort or the current itself; ampmode 0, or regulator pid or integer with a derivative gain above 0, is allowed"
        }
        Code::ESTIMATOR_RANGE => {
            "is beyond what a Kalman filter finds at this cycle, from 1e-10 to 1000 times 0.29 inc by the square of the cycle"
        }
        Code::CURRENT_UNKNOWN => {
            "is about a current, and without torque_constant none is known; its default is allowed"
        }
        Code::CURRENT_LOOP => {
            "is missing for the current loop of an axis with interface voltage; a value above 0 is expected, or ampmode 1 or 3, which have none"
        }
        Code::COMMUTATION => {
            "asks for a motor that is commutated here: there are no inputs for halls, no phases of a stepper and no second output; 0 and 1 (brushes) are allowed"
        }
        Code::GAIN_RANGE => {
            "is beyond the register of the integer PID, which closes the loop of the axis; 0 to 32767 is allowed, of saia.sampi 0 to 255"
        }
        Code::SIMULATED_EFFORT => {
            "is a simulated encoder, which follows the command: an axis with interface torque or voltage would find no velocity of its motor; another one is allowed"
        }
        Code::ENCODER_UNKNOWN_TYPE => "is no type of encoder",
        Code::WF_NO_CAM_SIDE => {
            "is no side of the cam; with an incremental encoder 0 (the one that JOG leads to), 1 (plus) and 2 (minus) are allowed"
        }
        Code::ENCODER_NEEDS_BUS => {
            "names a node of a bus, which an entry of encoders does (key feedback of the axis reads it); the types 0 to 5, \
             9, 10, 20, 30 exist, for a master 0, 1, 2, 5, 6, 10, 20, 30 and -1 to -999"
        }
        Code::ENCODER_NO_TERMINAL => {
            "names an entry of section encoders that the cell does not have: 10 is the first one"
        }
        Code::LEADER_LOOP => "names the axis itself; another one is allowed",
        Code::NO_MASTER => "names an axis that the cell does not have: -1 is the first one",
        Code::ENCODER_LOOP_IN_DRIVE => {
            "names an encoder that a drive with interface position does not close its loop with; 0, 1, 2, 5 and 9 are allowed"
        }
        Code::GANTRY_HOMING => {
            "does not square an axis with two drives; 0, 3 to 14, 19 to 30, 35, 37 and -1 to -4 are allowed"
        }
        Code::GANTRY_SOURCE => {
            "names another source than the two drives of the axis, which close their loops themselves"
        }
        Code::GANTRY_IN_DRIVE => "would let each of two drives of the axis move alone; false is allowed",
        Code::GANTRY_ONE_SWITCH => {
            "names the input of i_refswitch; each of two drives has a reference switch of its own"
        }
        Code::GANTRY_NO_LIMIT => "is missing for an axis with two drives; a distance above 0 is expected",
        Code::ENCODER_CHOSEN_TWICE => {
            "names another encoder than key feedback of the axis or its wf.md4 does; one of them may choose"
        }
        Code::WF_LOOP_IN_DRIVE => {
            "asks for words in Gray code, which a drive with interface position decodes itself; 0 (incremental) is allowed"
        }
        Code::ENCODER_NO_RATE => {
            "is no clock rate; 39000 to 5000000 Hz are allowed, or with encodertype 9 any distance of marks above 0"
        }
        Code::WF_NO_PARITY => {
            "is no parity; with wf.md4 absolute 0 inc (none), 1 inc (even) and 2 inc (odd) are allowed"
        }
        Code::NO_REVERSING_OUTPUTS => {
            "asks for a node on a bus, which key node of the drive does; below 100 is allowed"
        }
        Code::MARK_WINDOW => {
            "is larger than the distance of the marks; 0 to syncmpulsm, for syncmwins to syncmpulss, is allowed"
        }
        Code::MARKS_INACTIVE => {
            "asks with 64 for marks of an axis that is not coupled; sums of 1, 2, 4 and 16 are allowed"
        }
        Code::SYNC_OFFSET_RANGE => "is beyond its range; at most 1073741823 / syncfacts, either way, is allowed",
        Code::REVERSING_BY_POSITION => {
            "asks for outputs, which tell the sign of a velocity to drives with interface velocity or open_loop; 0, 1 and 2 \
             are allowed"
        }
        _ => "does not exist yet",
    }
}
