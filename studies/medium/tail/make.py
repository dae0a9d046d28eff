import math,sys
A=4e-4; W=4.0; F=24000.0
d=math.sqrt(2*math.pi/(0.8*math.sqrt(3)))
lx,ly=437*d,84*math.sqrt(3)*d
speed,seed=float(sys.argv[1]),int(sys.argv[2])
T=lx/speed
print(f'''schema = 1
[granular]
seed = {seed}
phi_b = 0.80
box = ["{lx:.12g} a", "{ly:.12g} a"]
start = "lattice"
equilibrate = "2 s"
duration = "{T:.6g} s"
[granular.body_force]
kind = "gaussian"
acceleration = {F/(2*math.pi*W*W)*A:.8g}
width = "{W} a"
speed = {speed*A:.8g}
[granular.output]
formats = ["h5md"]
last_period = false
checkpoint = "600 s"
frames = "0.1997 s"
''')
