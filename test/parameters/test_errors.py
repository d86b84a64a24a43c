"""Every error of a machine file, word for word."""

from pathlib import Path

import pytest

from cnc_ptp.parameters import ParameterError, load_machine, read_machine

MACHINE = "/machine: {ros__parameters: {channels: [ch], axes: [x, y], spindles: [s]}}\n"
AXES_ONLY = "/machine: {ros__parameters: {axes: [x, y]}}\n"
CHANNEL = """\
/ch:
  ros__parameters:
    gruppe.0.achse.0.log_achs_nr: 1
    spindel.0.log_achs_nr: 3
    spdl_anzahl: 1
    main_spindle_ax_nr: 3
"""
END = "; the node does not start"


def refusal(text: str) -> str:
    with pytest.raises(ParameterError) as caught:
        load_machine(text, "m.yaml")
    return str(caught.value)


def axis(parameters: str) -> str:
    """A machine whose axis x, in line 2, has the parameters."""
    return f"{AXES_ONLY}/x: {{ros__parameters: {parameters}}}\n"


def spindle(parameters: str) -> str:
    return f"/machine: {{ros__parameters: {{spindles: [s]}}}}\n/s: {{ros__parameters: {parameters}}}\n"


def channel(*lines: str) -> str:
    """A machine with two axes (1, 2) and a spindle (3) whose channel has the lines, from line 4 on."""
    return MACHINE + "/ch:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in lines)


CASES = {
    "syntax": (
        "/machine: {ros__parameters: {axes: [x}}\n",
        "P-ERR-25001 m.yaml:1:38: YAML syntax error, did not find expected ',' or ']'" + END,
    ),
    "tabulator": (
        "/machine:\n\tros__parameters: {}\n",
        "P-ERR-25001 m.yaml:2:1: YAML syntax error, found character that cannot start any token" + END,
    ),
    "control character": (
        "/machine: \x07",
        "P-ERR-25001 m.yaml:1:1: YAML cannot be read, control characters are not allowed" + END,
    ),
    "lone surrogate": (
        "/machine: \ud800",
        "P-ERR-25001 m.yaml:1:1: YAML cannot be read, surrogates not allowed" + END,
    ),
    "no mapping": ("- x\n", "P-ERR-25001 m.yaml:1:1: a machine file is a mapping of node names" + END),
    "two documents": (
        MACHINE + "---\n" + MACHINE,
        "P-ERR-25001 m.yaml:2:1: a machine file has one YAML document only" + END,
    ),
    "alias": (
        axis("{kopf: &kopf {achs_nr: 1}, kenngr: *kopf}"),
        "P-ERR-25001 m.yaml:2:58: anchors and aliases are not supported" + END,
    ),
    "alias as name": (
        "/machine: &m {ros__parameters: {}}\n*m : 1\n",
        "P-ERR-25001 m.yaml:2:1: a name must be plain text" + END,
    ),
    "nested list": (
        "/machine: {ros__parameters: {axes: [[x]]}}\n",
        "P-ERR-25001 m.yaml:1:37: a list holds plain values only" + END,
    ),
    "too deep": (
        "/machine: {ros__parameters: {" + "a: {" * 20 + "}" * 22,
        "P-ERR-25001 m.yaml:1:109: nested deeper than 20 levels" + END,
    ),
    "section no mapping": (MACHINE + "/x: 3\n", "P-ERR-25001 m.yaml:2:5: section /x must be a mapping" + END),
    "no ros__parameters": (
        AXES_ONLY + "/x: {kopf: {achs_nr: [1]}}\n",
        "P-ERR-25001 m.yaml:2:6: section /x has kopf where ros__parameters is expected" + END,
    ),
    "ros__parameters no mapping": (
        AXES_ONLY + "/x: {ros__parameters: [1, {a: 2}]}\n",
        "P-ERR-25001 m.yaml:2:23: ros__parameters of /x must be a mapping" + END,
    ),
    "duplicate section": (
        AXES_ONLY + "/x: {}\nx: {}\n",
        "P-ERR-25002 m.yaml:3:1: section /x is given twice, first in line 2" + END,
    ),
    "endless index": (
        AXES_ONLY + f"/x:\n  ros__parameters:\n    ? getriebe.{'9' * 5000}.kv\n    : 1\n",
        f"P-ERR-25005 m.yaml:5:7: axis /x has no parameter 'getriebe.{'9' * 47}..." + END,
    ),
    "duplicate ros__parameters": (
        AXES_ONLY + "/x:\n  ros__parameters: {kopf.achs_nr: 1}\n  ros__parameters: {kopf.achs_nr: 2}\n",
        "P-ERR-25002 m.yaml:4:3: /x has ros__parameters twice, first in line 3" + END,
    ),
    "duplicate key": (
        axis("{kopf: {achs_nr: 1},\n  kopf.achs_nr: 2}"),
        "P-ERR-25002 m.yaml:3:3: /x has kopf.achs_nr twice, first in line 2" + END,
    ),
    "no machine": (
        "/x: {}\n",
        "P-ERR-25003 m.yaml:1:1: section /machine is missing, it says which channels, axes and spindles exist" + END,
    ),
    "empty file": (
        "",
        "P-ERR-25003 m.yaml:1:1: section /machine is missing, it says which channels, axes and spindles exist" + END,
    ),
    "section without unit": (
        AXES_ONLY + "/xx: {}\n",
        "P-ERR-25004 m.yaml:2:1: section /xx has no unit in /machine (units: /x, /y); did you mean /x?" + END,
    ),
    "section without unit, nothing near": (
        "/machine: {}\n/q: {}\n",
        "P-ERR-25004 m.yaml:2:1: section /q has no unit in /machine (units: none)" + END,
    ),
    "unknown name": (
        axis('{getriebe: {"0": {kw: 5}}}'),
        "P-ERR-25005 m.yaml:2:45: axis /x has no parameter 'getriebe.0.kw'; did you mean getriebe[i].kv (P-AXIS-00099)?"
        + END,
    ),
    "unknown name, nothing near": (
        axis("{gain: 5}"),
        "P-ERR-25005 m.yaml:2:30: axis /x has no parameter 'gain'" + END,
    ),
    "name of another list": (
        axis("{max_vb_override: 5}"),
        "P-ERR-25005 m.yaml:2:41: axis /x has no parameter 'max_vb_override', P-CHAN-00056 belongs to channel nodes"
        + END,
    ),
    "name of two kinds of node": (
        "/machine: {ros__parameters: {kopf.achs_nr: 5}}\n",
        "P-ERR-25005 m.yaml:1:44: machine /machine has no parameter 'kopf.achs_nr', "
        "P-AXIS-00016 belongs to axis and spindle nodes" + END,
    ),
    "parameter of another axis type": (
        axis("{kenngr.vb_prozent: 5}"),
        "P-ERR-25005 m.yaml:2:43: axis list, P-AXIS-00217 kenngr.vb_prozent of /x: only spindles have this parameter, "
        "/x is one of the linear axes" + END,
    ),
    "parameter of other axis types": (
        spindle("{kenngr.swe_pos: 5}"),
        "P-ERR-25005 m.yaml:2:40: axis list, P-AXIS-00178 kenngr.swe_pos of /s: only linear axes and rotary axes have "
        "this parameter, /s is one of the spindles" + END,
    ),
    "index": (
        axis("{getriebe.6.kv: 5}"),
        "P-ERR-25006 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[6].kv of /x: index 6 is outside 0 to 5" + END,
    ),
    "inner index": (
        channel("gruppe.0.achse.32.bezeichnung: X"),
        "P-ERR-25006 m.yaml:4:36: channel list, P-CHAN-00006 gruppe[0].achse[32].bezeichnung of /ch: "
        "index 32 is outside 0 to 31" + END,
    ),
    "text for a number": (
        axis("{'getriebe[0].kv': fast}"),
        "P-ERR-25007 m.yaml:2:42: axis list, P-AXIS-00099 getriebe[0].kv of /x: value 'fast' is text, "
        "an integer is needed" + END,
    ),
    "fraction for an integer": (
        axis("{getriebe.0.kv: 5.5}"),
        "P-ERR-25007 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value 5.5 is a number, "
        "an integer is needed" + END,
    ),
    "octal": (
        axis("{getriebe.0.kv: 0100}"),
        "P-ERR-25007 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value '0100' is text, "
        "an integer is needed" + END,
    ),
    "boolean for an integer": (
        axis("{getriebe.0.kv: yes}"),
        "P-ERR-25007 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value true is a boolean, "
        "an integer is needed" + END,
    ),
    "nothing": (
        axis("{getriebe.0.kv: }"),
        "P-ERR-25007 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value null is nothing, "
        "an integer is needed" + END,
    ),
    "list for a number": (
        axis("{simulation.start_position: [1, a]}"),
        "P-ERR-25007 m.yaml:2:51: simulation list, P-SIM-00003 simulation.start_position of /x: "
        "value [1, 'a'] is a list, a number is needed" + END,
    ),
    "number for a boolean": (
        axis("{simulation.encoder: 2}"),
        "P-ERR-25007 m.yaml:2:44: simulation list, P-SIM-00002 simulation.encoder of /x: value 2 is an integer, "
        "true or false (1 or 0) is needed" + END,
    ),
    "number for text": (
        axis("{kopf.log_achs_name: 2}"),
        "P-ERR-25007 m.yaml:2:44: axis list, P-AXIS-00297 kopf.log_achs_name of /x: value 2 is an integer, "
        "text is needed" + END,
    ),
    "numbers in a list of names": (
        axis("{antr.telegram.feedback: [606C, 6064, 6077]}"),
        "P-ERR-25007 m.yaml:2:48: machine list, P-MACH-00021 antr.telegram.feedback of /x: entry 6064 is a number, "
        'names are text, quote it: "6064"' + END,
    ),
    "no text in a list of names": (
        axis("{antr.telegram.feedback: [606C, null]}"),
        "P-ERR-25007 m.yaml:2:48: machine list, P-MACH-00021 antr.telegram.feedback of /x: entry null is nothing, a "
        "list of names is needed" + END,
    ),
    "text for a list of names": (
        "/machine: {ros__parameters: {axes: x}}\n",
        "P-ERR-25007 m.yaml:1:36: machine list, P-MACH-00005 axes of /machine: value 'x' is text, "
        "a list of names is needed" + END,
    ),
    "boolean for a constant": (
        axis("{kenngr.achs_typ: on}"),
        "P-ERR-25007 m.yaml:2:41: axis list, P-AXIS-00018 kenngr.achs_typ of /x: value true is a boolean, "
        "a constant or its number is needed" + END,
    ),
    "below an exclusive minimum": (
        axis("{getriebe.0.kv: 0}"),
        "P-ERR-25008 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value 0 is not above 0 (0.01/s)" + END,
    ),
    "below a minimum": (
        axis("{getriebe.0.dynamik.vb_max: 0}"),
        "P-ERR-25008 m.yaml:2:51: axis list, P-AXIS-00212 getriebe[0].dynamik.vb_max of /x: "
        "value 0 is below the minimum 1 µm/s" + END,
    ),
    "above a maximum, spindle units": (
        spindle("{getriebe.0.dynamik.vb_max: 2000000001}"),
        "P-ERR-25008 m.yaml:2:51: axis list, P-AXIS-00212 getriebe[0].dynamik.vb_max of /s: "
        "value 2000000001 is above the maximum 2000000000 (0.001°/s)" + END,
    ),
    "above an exclusive maximum": (
        axis("{kopf.achs_nr: 65535}"),
        "P-ERR-25008 m.yaml:2:38: axis list, P-AXIS-00016 kopf.achs_nr of /x: value 65535 is not below 65535" + END,
    ),
    "above the data type": (
        axis("{getriebe.0.kv: 4294967296}"),
        "P-ERR-25008 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: "
        "value 4294967296 is above the maximum 4294967295 (0.01/s)" + END,
    ),
    "not a number": (
        axis("{simulation.start_position: .nan}"),
        "P-ERR-25008 m.yaml:2:51: simulation list, P-SIM-00003 simulation.start_position of /x: "
        "value nan is not a finite number" + END,
    ),
    "infinite": (
        axis("{simulation.start_position: -.inf}"),
        "P-ERR-25008 m.yaml:2:51: simulation list, P-SIM-00003 simulation.start_position of /x: "
        "value -inf is not a finite number" + END,
    ),
    "huge integer for a float": (
        axis("{simulation.start_position: 1" + "0" * 400 + "}"),
        "P-ERR-25008 m.yaml:2:51: simulation list, P-SIM-00003 simulation.start_position of /x: "
        "value inf is not a finite number" + END,
    ),
    "huge integer": (
        axis("{getriebe.0.kv: 1" + "0" * 400 + "}"),
        "P-ERR-25008 m.yaml:2:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value 1" + "0" * 56 + "... "
        "is above the maximum 4294967295 (0.01/s)" + END,
    ),
    "none of the numbers": (
        axis("{ptp.override_type: 5}"),
        "P-ERR-25008 m.yaml:2:43: machine list, P-MACH-00007 ptp.override_type of /x: value 5 is none of "
        "1 (reduced), 2 (original), 3 (reduced iterated), 4 (original iterated)" + END,
    ),
    "none of the constants": (
        axis("{kenngr.achs_typ: ROTARY}"),
        "P-ERR-25008 m.yaml:2:41: axis list, P-AXIS-00018 kenngr.achs_typ of /x: value 'ROTARY' "
        "is none of ACHSTYP_TRANSLATOR, ACHSTYP_ROTATOR, ACHSTYP_SPINDEL" + END,
    ),
    "number without a constant": (
        axis("{kenngr.achs_typ: 3}"),
        "P-ERR-25008 m.yaml:2:41: axis list, P-AXIS-00018 kenngr.achs_typ of /x: value 3 is none of "
        "ACHSTYP_TRANSLATOR 0x1, ACHSTYP_ROTATOR 0x2, ACHSTYP_SPINDEL 0x4" + END,
    ),
    "wrong flag": (
        channel("m_synch.8: MVS_SVS | PLC"),
        "P-ERR-25008 m.yaml:4:16: channel list, P-CHAN-00041 m_synch[8] of /ch: value 'MVS_SVS | PLC' has 'PLC', which "
        "is none of NO_SYNCH, MOS, MVS_SVS, MVS_SNS, MNS_SNS, MNE_SNS, MVS_SLM, MVS_SLP, PLC_INFO" + END,
    ),
    "bits without flag": (
        channel("m_synch.8: 0x20012"),
        "P-ERR-25008 m.yaml:4:16: channel list, P-CHAN-00041 m_synch[8] of /ch: value 131090 is not a combination of "
        "NO_SYNCH 0x0, MOS 0x1, MVS_SVS 0x2, MVS_SNS 0x4, MNS_SNS 0x8, MNE_SNS 0x20, MVS_SLM 0x4000, MVS_SLP 0x8000, "
        "PLC_INFO 0x20000" + END,
    ),
    "text too long": (
        channel("gruppe.0.bezeichnung: ABCDEFGHIJKLMNOPQ"),
        "P-ERR-25008 m.yaml:4:27: channel list, P-CHAN-00005 gruppe[0].bezeichnung of /ch: "
        "value 'ABCDEFGHIJKLMNOPQ' is longer than 16 characters" + END,
    ),
    "text of wrong form": (
        channel("main_spindle_name: T"),
        "P-ERR-25008 m.yaml:4:24: channel list, P-CHAN-00053 main_spindle_name of /ch: "
        "value 'T' must be a capital S, then capital letters, digits and _" + END,
    ),
    "soft limits": (
        axis("{kenngr.swe_neg: 5, kenngr.swe_pos: 5}"),
        "P-ERR-25009 m.yaml:2:40: axis list, P-AXIS-00177 kenngr.swe_neg of /x: value 5 is not below 5 (0.1 µm) of "
        "P-AXIS-00178 kenngr.swe_pos in line 2" + END,
    ),
    "soft limit of a conveyor": (
        axis("{kenngr: {achs_mode: 0x4, swe_pos: 1000000}}"),
        "P-ERR-25009 m.yaml:2:58: axis list, P-AXIS-00178 kenngr.swe_pos of /x: value 1000000 would not limit the axis, "
        "P-AXIS-00015 kenngr.achs_mode 0x4 makes it an endless modulo axis; leave out one of the two" + END,
    ),
    "negative soft limit of a conveyor": (
        axis("{kenngr: {achs_mode: 0x1400, swe_neg: -77}}"),
        "P-ERR-25009 m.yaml:2:61: axis list, P-AXIS-00177 kenngr.swe_neg of /x: value -77 would not limit the axis, "
        "P-AXIS-00015 kenngr.achs_mode 0x1400 makes it an endless modulo axis; leave out one of the two" + END,
    ),
    "soft limit against default": (
        axis("{kenngr.swe_pos: -100000000}"),
        "P-ERR-25009 m.yaml:2:40: axis list, P-AXIS-00178 kenngr.swe_pos of /x: value -100000000 is not above "
        "-100000000 (0.1 µm) of P-AXIS-00177 kenngr.swe_neg by default" + END,
    ),
    "acceleration above a_max": (
        axis("{getriebe.0.slope_profil.a_beschl: 2000}"),
        "P-ERR-25009 m.yaml:2:58: axis list, P-AXIS-00001 getriebe[0].slope_profil.a_beschl of /x: value 2000 is above "
        "the maximum 1000 mm/s² of P-AXIS-00008 getriebe[0].dynamik.a_max by default" + END,
    ),
    "rapid above vb_max": (
        axis('{getriebe: {"1": {vb_eilgang: 11, dynamik.vb_max: 10}}}'),
        "P-ERR-25009 m.yaml:2:53: axis list, P-AXIS-00209 getriebe[1].vb_eilgang of /x: value 11 is above the maximum "
        "10 µm/s of P-AXIS-00212 getriebe[1].dynamik.vb_max in line 2" + END,
    ),
    "ramp below tr_min": (
        axis("{getriebe.0.slope_profil.tr_beschl_zu: 9999}"),
        "P-ERR-25009 m.yaml:2:62: axis list, P-AXIS-00196 getriebe[0].slope_profil.tr_beschl_zu of /x: value 9999 is "
        "below the minimum 10000 µs of P-AXIS-00201 getriebe[0].dynamik.tr_min by default" + END,
    ),
    "emergency ramp": (
        axis("{getriebe.0.dynamik.a_emergency: 2001}"),
        "P-ERR-25009 m.yaml:2:56: axis list, P-AXIS-00003 getriebe[0].dynamik.a_emergency of /x: value 2001 is above "
        "the maximum 2000 mm/s², twice P-AXIS-00008 getriebe[0].dynamik.a_max by default" + END,
    ),
    "duplicate number": (
        AXES_ONLY + "/x: {ros__parameters: {kopf.achs_nr: 7}}\n/y: {ros__parameters: {kopf.achs_nr: 7}}\n",
        "P-ERR-25010 m.yaml:3:38: axis list, P-AXIS-00016 kopf.achs_nr of /y: "
        "value 7 is the logical axis number of /x already" + END,
    ),
    "number listed twice in a channel": (
        channel("gruppe.0.achse.0.log_achs_nr: 1", "gruppe.0.achse.1: {log_achs_nr: 1, bezeichnung: Y}"),
        "P-ERR-25010 m.yaml:5:37: channel list, P-CHAN-00035 gruppe[0].achse[1].log_achs_nr of /ch: "
        "value 1 is listed twice in the channel" + END,
    ),
    "axis in two channels": (
        "/machine: {ros__parameters: {channels: [a, b], axes: [x]}}\n"
        "/a: {ros__parameters: {gruppe.0.achse.0.log_achs_nr: 1}}\n"
        "/b: {ros__parameters: {gruppe.0.achse.0.log_achs_nr: 1}}\n",
        "P-ERR-25010 m.yaml:3:54: channel /b: axis /x belongs to channel /a already" + END,
    ),
    "axis in two channels that list none": (
        "/machine: {ros__parameters: {channels: [a, b], axes: [x]}}\n/b: {}\n",
        "P-ERR-25010 m.yaml:2:1: channel /b: axis /x belongs to channel /a already" + END,
    ),
    "spindle under axes": (
        axis("{kenngr.achs_typ: ACHSTYP_SPINDEL}"),
        "P-ERR-25011 m.yaml:2:41: axis list, P-AXIS-00018 kenngr.achs_typ of /x: value ACHSTYP_SPINDEL does not fit, "
        "/machine has /x under axes, it belongs under spindles" + END,
    ),
    "axis under spindles": (
        spindle("{kenngr.achs_typ: 0x2}"),
        "P-ERR-25011 m.yaml:2:41: axis list, P-AXIS-00018 kenngr.achs_typ of /s: value ACHSTYP_ROTATOR does not fit, "
        "/machine has /s under spindles, it belongs under axes" + END,
    ),
    "spindle as path axis": (
        channel("gruppe.0.achse.0: {log_achs_nr: 3, bezeichnung: C}"),
        "P-ERR-25011 m.yaml:4:37: channel list, P-CHAN-00035 gruppe[0].achse[0].log_achs_nr of /ch: "
        "value 3 is /s, a spindle cannot be a path axis" + END,
    ),
    "path axis as spindle": (
        channel("spindel.0: {log_achs_nr: 1, bezeichnung: S1}", "spdl_anzahl: 1", "main_spindle_ax_nr: 1"),
        "P-ERR-25011 m.yaml:4:30: channel list, P-CHAN-00036 spindel[0].log_achs_nr of /ch: "
        "value 1 is /x, a path axis cannot be a spindle" + END,
    ),
    "spindle count": (
        channel("spindel.0.log_achs_nr: 3", "main_spindle_ax_nr: 3"),
        "P-ERR-25012 m.yaml:2:1: channel list, P-CHAN-00082 spdl_anzahl of /ch: "
        "value 0, but 1 spindles are listed (spindel[i])" + END,
    ),
    "axis count": (
        channel("gruppe.0.achs_anzahl: 2", "gruppe.0.achse.0.log_achs_nr: 1"),
        "P-ERR-25012 m.yaml:4:27: channel list, P-CHAN-00003 gruppe[0].achs_anzahl of /ch: "
        "value 2, but 1 axes are listed (achse[j])" + END,
    ),
    "no main spindle": (
        channel("spindel.0.log_achs_nr: 3", "spdl_anzahl: 1"),
        "P-ERR-25013 m.yaml:2:1: channel list, P-CHAN-00051 main_spindle_ax_nr of /ch: "
        "no value is given, it must be one of the channel's spindles (3)" + END,
    ),
    "wrong main spindle": (
        channel("spindel.0.log_achs_nr: 3", "spdl_anzahl: 1", "main_spindle_ax_nr: 1"),
        "P-ERR-25013 m.yaml:6:25: channel list, P-CHAN-00051 main_spindle_ax_nr of /ch: "
        "value 1 is not one of the channel's spindles (3)" + END,
    ),
    "no such axis": (
        channel("gruppe.0.achse.0: {log_achs_nr: 9, bezeichnung: X}"),
        "P-ERR-25014 m.yaml:4:37: channel list, P-CHAN-00035 gruppe[0].achse[0].log_achs_nr of /ch: "
        "value 9 is not a logical axis number of the machine (1 /x, 2 /y, 3 /s)" + END,
    ),
    "no such axis, no axes": (
        "/machine: {ros__parameters: {channels: [ch]}}\n/ch: {ros__parameters: {gruppe.0.achse.0.log_achs_nr: 9}}\n",
        "P-ERR-25014 m.yaml:2:55: channel list, P-CHAN-00035 gruppe[0].achse[0].log_achs_nr of /ch: "
        "value 9 is not a logical axis number of the machine (none)" + END,
    ),
    "axis without number": (
        channel("gruppe.0.achse.0: {bezeichnung: X}"),
        "P-ERR-25014 m.yaml:2:1: channel list, P-CHAN-00035 gruppe[0].achse[0].log_achs_nr of /ch: "
        "no logical axis number is given" + END,
    ),
    "unit twice": (
        "/machine: {ros__parameters: {axes: [x], spindles: [x]}}\n",
        "P-ERR-25015 m.yaml:1:51: machine list, P-MACH-00006 spindles of /machine: unit name 'x' is given twice" + END,
    ),
    "unit name taken": (
        "/machine: {ros__parameters: {axes: [plc]}}\n",
        "P-ERR-25015 m.yaml:1:36: machine list, P-MACH-00005 axes of /machine: "
        "unit name 'plc' is taken by another node" + END,
    ),
    "unit name in capitals": (
        "/machine: {ros__parameters: {axes: [X]}}\n",
        "P-ERR-25015 m.yaml:1:36: machine list, P-MACH-00005 axes of /machine: "
        "unit name 'X' must be lower-case letters, digits and _, beginning with a letter" + END,
    ),
    "node name that is no spindle name": (
        "/machine: {ros__parameters: {channels: [ch, ch2], spindles: [main, tool]}}\n"
        "/ch2: {ros__parameters: {spdl_anzahl: 2, main_spindle_ax_nr: 1, spindel.0.log_achs_nr: 1,\n"
        "  spindel.1.log_achs_nr: 2}}\n/ch: {ros__parameters: {spdl_anzahl: 1, main_spindle_ax_nr: 1,\n"
        "  spindel.0.log_achs_nr: 1}}\n",
        "P-ERR-25015 m.yaml:2:1: channel /ch2: /tool would be called TOOL, the first letter must be one of S: "
        "give spindel[i].bezeichnung" + END,
    ),
    "node name that is no axis name": (
        "/machine: {ros__parameters: {channels: [ch], axes: [table]}}\n",
        "P-ERR-25015 m.yaml:1:1: channel /ch: /table would be called TABLE, the first letter must be one of "
        "A, B, C, U, V, W, X, Y, Z, Q: give gruppe[i].achse[j].bezeichnung" + END,
    ),
    "program name twice": (
        channel("gruppe.0.achse.0.log_achs_nr: 1", "gruppe.0.achse.1: {log_achs_nr: 2, bezeichnung: X}"),
        "P-ERR-25015 m.yaml:5:53: channel /ch: program name X is used twice" + END,
    ),
    "resolution zero": (
        axis("{antr.feed_const_num: 50000, getriebe.0.incr_per_rev: 0}"),
        "P-ERR-25016 m.yaml:2:77: axis list, P-AXIS-00092 getriebe[0].incr_per_rev of /x: value 0 makes the encoder "
        "resolution zero, P-AXIS-00362 and P-AXIS-00363 (feed constant) are in use" + END,
    ),
    "resolution twice": (
        axis("{antr.feed_const_denom: 2, getriebe.0.wegaufz: 3}"),
        "P-ERR-25016 m.yaml:2:70: axis list, P-AXIS-00234 getriebe[0].wegaufz of /x: value 3 must be 1, "
        "P-AXIS-00362 and P-AXIS-00363 (feed constant) give the resolution" + END,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_error_text(case: str) -> None:
    text, expected = CASES[case]
    assert refusal(text) == expected


def test_all_problems_come_at_once_in_the_order_of_the_file() -> None:
    text = CHANNEL.replace("/ch:", "/chan:") + MACHINE + "/x: {ros__parameters: {getriebe.0.kv: 0, kopf.nr: 1}}\n"
    with pytest.raises(ParameterError) as caught:
        load_machine(text, "m.yaml")
    assert str(caught.value).splitlines() == [
        "P-ERR-25004 m.yaml:1:1: section /chan has no unit in /machine (units: /ch, /x, /y, /s); did you mean /ch?"
        + END,
        "P-ERR-25008 m.yaml:8:39: axis list, P-AXIS-00099 getriebe[0].kv of /x: value 0 is not above 0 (0.01/s)" + END,
        "P-ERR-25005 m.yaml:8:51: axis /x has no parameter 'kopf.nr'; did you mean kopf.achs_nr (P-AXIS-00016)?" + END,
    ]
    assert caught.value.number == 25004
    assert [problem.error_id for problem in caught.value.problems] == [25004, 25008, 25005]


def test_a_refused_value_raises_no_second_problem() -> None:
    assert refusal(axis("{kenngr.swe_neg: 0, kenngr.swe_pos: low}")).count("\n") == 0
    assert refusal(channel("gruppe.0.achse.0: {log_achs_nr: one, bezeichnung: X}")).count("\n") == 0
    assert refusal(channel("spindel.0.log_achs_nr: 3", "spdl_anzahl: one", "main_spindle_ax_nr: 3")).count("\n") == 0
    assert refusal(axis("{kopf.achs_nr: one}")).count("\n") == 0


def test_unreadable_file(tmp_path: Path) -> None:
    missing, binary = tmp_path / "missing.yaml", tmp_path / "binary.yaml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ParameterError) as caught:
        read_machine(missing)
    assert str(caught.value) == (
        f"P-ERR-25017 {missing}:1:1: machine file cannot be read, No such file or directory" + END
    )
    with pytest.raises(ParameterError) as caught:
        read_machine(binary)
    assert str(caught.value) == f"P-ERR-25017 {binary}:1:1: machine file cannot be read, it is not UTF-8 text" + END


def test_a_deep_file_is_refused_quickly() -> None:
    for opening in ("{a: ", "[", "- "):
        assert refusal("/machine: " + opening * 50_000).startswith("P-ERR-25001 m.yaml:")
