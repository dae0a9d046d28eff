import sys,numpy as np,h5py,csv,gzip
A=4e-4
folder,speed,out=sys.argv[1],float(sys.argv[2]),sys.argv[3]
with h5py.File(folder+'/trajectory.h5md') as f:
    g=f['particles/trajectory']; e=g['box/edges/value'][0]; box=np.array([e[0,0],e[1,1]])/A
    t=g['position/time'][()]
    pv=g['position/value']; im=g['image/value']
    n=pv.shape[0]
    start=None; nx,ny=310,103
    sums={}
    for k in range(n):
        p=pv[k,:,:2]/A+im[k,:,:2]*box
        c=p.mean(axis=0); p=p-c
        if start is None: start=p.copy(); continue
        if t[k]<0: start=p.copy(); continue
        u=p-start
        keep=np.hypot(u[:,0],u[:,1])<1.065
        frac=1-keep.mean()
        # place of the bead's rest site relative to the force's centre; force starts in the middle of the box
        r=start+c-(box/2+np.array([speed*t[k],0]))
        r-=box*np.round(r/box)
        ix=((r[:,0]/box[0]+.5)*nx).astype(int)%nx; iy=((r[:,1]/box[1]+.5)*ny).astype(int)%ny
        w=int(t[k]*speed//100)  # windows of 100 a of way
        s=sums.setdefault(w,np.zeros((4,nx*ny)))
        idx=(ix*ny+iy)[keep]
        s[0]+=np.bincount(idx,minlength=nx*ny); s[1]+=np.bincount(idx,u[keep,0],nx*ny); s[2]+=np.bincount(idx,u[keep,1],nx*ny)
        s[3]+=frac/ (nx*ny)
np.savez_compressed(out,box=box,windows=np.array(sorted(sums)),sums=np.array([sums[w] for w in sorted(sums)],dtype=np.float32).reshape(len(sums),4,nx,ny),times=t)
