"""Text tables: what spreadsheets, loggers and measuring programs call CSV.

The steps, one a module: ``encoding`` (bytes to text), ``layout`` (which line is the header, which
sign separates), ``rows`` (text to columns of cells), ``numbers`` (cells to numbers: the decimal
sign) and ``instants`` (cells to time). ``reader`` takes them in this order.
"""

from steering_diagnosis.data.foreign.csv_table.reader import read_csv

__all__ = ["read_csv"]
