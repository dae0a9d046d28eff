#!/bin/sh
# cpu_seconds.sh PID FILE: adds a line to FILE, the CPU seconds (user + system, all threads) that process PID has used so far.
ticks=$(getconf CLK_TCK)
awk -v hz="$ticks" '{ printf "%.3f\n", ($14 + $15) / hz }' "/proc/$1/stat" >> "$2"
