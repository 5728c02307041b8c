"""Casts in the layouts of instruments and survey programs, written here after real files."""

import gsw
import numpy as np
import pytest

from insonify.acoustics.water import make_sound_speed_field
from insonify.io.sound_speed_casts import read_cast
from insonify.scene import load_scene

DEPTH = np.arange(1.0, 21.0)
SPEED = 1510.0 - 0.5 * DEPTH
TEMPERATURE = 18.0 - 0.2 * DEPTH


def clock(k, date="2019/03/12 "):
    return f"{date}15:59:{20.0 + 2.0 * k:06.3f}" if k < 20 else f"{date}16:00:{2.0 * (k - 20):06.3f}"


# Lines before the rows, a row from number, depth, pressure, sound speed and temperature, and lines behind the rows.
LAYOUTS = {
    # Valeport SWIFT: names and units in two lines after ``[DATA]``, tabs between columns.
    "a.vp2": (
        ["[HEADER]", "Instrument=SWIFT SVP", "Latitude=38.3", "", "[COLUMNS]", "Depth=Float;m;Calculated", "", "[DATA]",
         "Date/Time\tDepth\tPressure\tSound Velocity\tTemperature\tSalinity\tDensity\tConductivity\t",
         "\tm\tdBar\tMs-1\tDegC\tPSU\tkg/M3\tmS/M"],
        lambda k, d, p, c, t: f"{clock(k)}\t{d:.3f}\t{d * 1.01:.3f}\t{c:.3f}\t{t:.3f}\t31.0\t1006.9\t9.5",
        [],
    ),
    # Valeport MIDAS: the unit of a column stands before the name of the next; pressure alone.
    "a.000": (
        ["Previous File Location :\t786432", "Model Name :\tMIDAS SVP 6000", "Density :\t1025.973",
         "Date / Time\tSOUND VELOCITY;DBAR\tPRESSURE;C\tTEMPERATURE;\t",
         "10/05/2012 15:59:10.000\t0.000\t-0.064\t10.671\t"],
        lambda k, d, p, c, t: f"{clock(k, '10/05/2012 ')}\t{c:.3f}\t{p:.3f}\t{t:.3f}\t",
        [],
    ),
    # AML: sections, of which one names its columns and another holds the rows; date and time apart.
    "a.aml": (
        ["[Header]", "Date=2020-06-23", "Latitude=48.56", "[SensorMetaData]",
         "Columns=Port,Model,SerialNumber,Firmware,Parameter,Units", "[SensorData]",
         "3,P.X2,306674,1.00.1,Pressure,dbar", "[MeasurementMetadata]", "Columns=Date,Time,Cond,TempCT,SV,Pressure",
         "Units=yyyy-mm-dd,hh:mm:ss.ss,mS/cm,C,m/s,dbar", "", "[MeasurementData]"],
        lambda k, d, p, c, t: f"2020-06-23,{clock(k, '')},37.2,{t:.3f},{c:.3f},{p:.3f}",
        ["2020-06-23,16:00:30.00,0.0,16.4,0.000,-0.11"],
    ),
    # CastAway: marks of comments, and names with units in brackets.
    "a.csv": (
        ["% Device,11E101663", "% Start latitude,43.0", "% ",
         "Pressure (Decibar),Depth (Meter),Temperature (Celsius),Conductivity (MicroSiemens per Centimeter),"
         "Specific conductance (MicroSiemens per Centimeter),Salinity (Practical Salinity Scale),"
         "Sound velocity (Meters per Second),Density (Kilograms per Cubic Meter)"],
        lambda k, d, p, c, t: f"{d * 1.01},{d},{t},41824.9,48221.9,31.2,{c},1022.3",
        [],
    ),
    "a.vel": (  # HYPACK
        ["FTP NEW 3 37.998879852 -122.416305140 15:47 08/19/2019"],
        lambda k, d, p, c, t: f"{d:.1f} {c:.2f}",
        [],
    ),
    # AML CALC of a Moving Vessel Profiler: closed by a row of zeros, navigation behind it.
    "a.calc": (
        ["CALC,0004,08-30-2017,1,meters", "AML SOUND VELOCITY PROFILER S/N:00000", "DATE:17242 TIME:2334",
         "DEPTH OFFSET (M):00000.0", "DEPTH (M) VELOCITY (M/S) TEMP (C)"],
        lambda k, d, p, c, t: f"   {d:.1f}  {c:.2f}  {t:.3f} ",
        [" 0  0  0 ", "*** NAV ****", "Bottom Depth (m): 12.8", "LAT ( ddmm.mmmmmmm,N):  3024.6128000,N"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", LAYOUTS)
def test_depth_and_sound_speed_are_those_of_the_file(tmp_path, name):
    head, row, tail = LAYOUTS[name]
    columns = zip(DEPTH, gsw.p_from_z(-DEPTH, 45.0), SPEED, TEMPERATURE)
    rows = [row(k, *values) for k, values in enumerate(columns)]
    (tmp_path / name).write_text("\n".join([*head, *rows, *tail]))
    cast = read_cast(str(tmp_path / name))
    np.testing.assert_allclose(cast.depth, DEPTH, atol=2e-3)
    np.testing.assert_allclose(cast.sound_speed, SPEED, atol=6e-3)
    if name in ("a.vp2", "a.csv"):  # with salinity; alone it says nothing beside the speed
        np.testing.assert_allclose(cast.temperature, TEMPERATURE, atol=2e-3)
    scene = tmp_path / "scene.toml"
    scene.write_text(f'[seabed]\ndepth = 15.0\n[track]\naltitude = 5.0\n[water]\nkind = "cast"\npath = "{name}"\n')
    assert make_sound_speed_field(load_scene(scene).water).depth.size > 1
