"""Engineering measures of a result: functions of a Dataset that return arrays with units."""
