"""Every table reads as README says: pandas.read_csv(path, sep="\\t", comment="#").

    tests/tables.py FOLDER...

Names, rows and numbers are those of a plain reader of lines and tabs, and a column of numbers is one
of numbers, not of words; with float_precision="round_trip" they have the same bits, which pandas'
default loses behind the 13th digit. Exit 77 where there is no pandas.
"""
import glob
import math
import sys

try:
    import pandas
except ImportError:
    print("skipped: a reading by pandas, for there is no python3-pandas")
    sys.exit(77)


def number(cell):
    try:
        return float(cell) if cell else math.nan
    except ValueError:
        return None


def check(path):
    with open(path, encoding="utf-8") as file:
        lines = [line.rstrip("\n") for line in file]
    rows = [line.split("\t") for line in lines if line and not line.startswith("#")]
    names, rows = rows[0], rows[1:]
    table = pandas.read_csv(path, sep="\t", comment="#")
    exact = pandas.read_csv(path, sep="\t", comment="#", float_precision="round_trip")
    assert list(table.columns) == names, f"{path}: columns {list(table.columns)}, not {names}"
    assert len(set(names)) == len(names), f"{path}: a name twice"
    assert isinstance(table.index, pandas.RangeIndex), f"{path}: rows longer than names"
    assert len(table) == len(rows), f"{path}: {len(table)} rows, not {len(rows)}"
    for row in rows:
        assert len(row) == len(names), f"{path}: {len(row)} cells for {len(names)} names: {row}"
        assert not any("#" in cell for cell in row), f"{path}: a cell with #: {row}"
    for k, name in enumerate(names):
        cells = [number(row[k]) for row in rows]
        if rows and None not in cells:
            assert table[name].dtype.kind in "if", f"{path}: {name} is {table[name].dtype}"
            for cell, near, same in zip(cells, table[name], exact[name]):
                if math.isnan(cell):
                    assert math.isnan(near) and math.isnan(same), f"{path}: {name}: {near}"
                else:
                    assert math.isclose(cell, near, rel_tol=1e-11), f"{path}: {name}: {near}"
                    assert cell == same, f"{path}: {name}: {same}"


paths = sorted(path for folder in sys.argv[1:] for path in glob.glob(folder + "/*.tsv"))
for path in paths:
    check(path)
print(f"{len(paths)} tables read by pandas {pandas.__version__}")
sys.exit(0 if paths else 1)
