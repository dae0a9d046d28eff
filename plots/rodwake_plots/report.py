def write(run, figures): pass
