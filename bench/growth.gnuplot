# The growth of the time of a build as a drawing: gnuplot -e "table='TABLE.csv'; drawing='OUT.svg'" growth.gnuplot
set terminal svg size 760,420 font "sans-serif,13" background "white"
set output drawing
set datafile separator ","
set logscale x
set yrange [0:]
set format x "10^{%L}"
set xlabel "triangles N"
set ylabel "ns of processor time over N log_2 N"
set grid
set key outside below

# Columns: 1 experiment, 2 plan, 5 triangles, 11 the figure.
of(plan) = strcol(1) eq "growth" && strcol(2) eq plan ? column(11) : NaN
set datafile missing NaN
plot for [plan in "'split=binned' 'split=sweep straddle=general' 'split=sweep straddle=clip' 'split=object'"] \
    table using 5:(of(plan)) with linespoints linewidth 2 pointtype 7 pointsize 0.6 title plan noenhanced
