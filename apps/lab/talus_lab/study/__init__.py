"""What studies share: configs and their faults, formulas in texts, tables that are kept from run to run, pages and pictures."""
