import numpy as np,sys,glob
speed=float(sys.argv[1]); S=0
for f in sorted(glob.glob(f'/work/tail/{int(speed)}_*.npz')):
    z=np.load(f); box=z['box']; w=z['windows']; s=z['sums'].astype(float)
    sel=(w>=4)&(w<=8); S=S+s[sel].sum(axis=0)
nx,ny=S.shape[1:]
F=24000.; rho=1
c11,c22,c12,c66=[1.27*x for x in (8.11,8.29,2.6,2.92)]
print(f)
n,ux,uy,h=S
x=((np.arange(nx)+.5)/nx-.5)*box[0]; y=((np.arange(ny)+.5)/ny-.5)*box[1]
# density: mass per area in kg/m2: phi 0.8*4/3*a*rho
dens=0.8*4/3*4e-4*2700; A=4e-4
C=[c*1e-3/dens/A**2 for c in (9.75,9.83,2.69,3.55)]
zeta=13.94; ms=1.3; nu=0.
def theory():
    q1=2*np.pi*np.fft.fftfreq(nx,1/nx)/box[0]; q2=2*np.pi*np.fft.fftfreq(ny,1/ny)/box[1]
    X,Y=np.meshgrid(q1,q2,indexing='ij'); v=speed
    mo=-1j*zeta*v*X-ms*v**2*X**2
    xx,yy,xy=C[0]*X**2+C[3]*Y**2+mo,C[3]*X**2+C[1]*Y**2+mo,(C[2]+C[3])*X*Y
    p=F*np.exp(-(X**2+Y**2)*16/2)/box.prod(); D=xx*yy-xy**2; D[0,0]=1
    U=yy*p/D; U[0,0]=0
    ph=np.exp(1j*(X*x[0]+Y*y[0]))
    return np.real(np.fft.ifft2(U*ph)*nx*ny)
T=theory()
band=np.abs(y)<4.6
m=ux[:,band].sum(1)/n[:,band].sum(1); t=T[:,band].mean(1)
print('mu/rho',C[3],'xi',C[3]/zeta/speed,'f/mu',F/C[3])
for a in range(-300,301,20):
    b=(x>=a-10)&(x<a+10)
    print(f'{a:5d} {m[b].mean():7.4f} theory {t[b].mean():7.4f}')
