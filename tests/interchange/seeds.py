"""Files that are damaged by the fuzz: small ones of every format, and of the installed packages those under 12 kB."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from package_files import mjcf_files, urdf_files

_LINK = '<inertial><origin xyz="0 0 1" rpy="0 1 0"/><mass value="2"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
URDF = f"""<robot name="r"><link name="a"/><link name="b">{_LINK}</link><link name="c">{_LINK}</link><link name="d"/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><origin xyz="1 2 3" rpy="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="1" friction="1"/></joint>
<joint name="k" type="planar"><parent link="b"/><child link="c"/><axis xyz="0 1 1"/></joint>
<joint name="l" type="fixed"><parent link="c"/><child link="d"/><origin xyz="1 2 3"/></joint>
<link name="e">{_LINK}</link><joint name="m" type="continuous"><parent link="d"/><child link="e"/>
<mimic joint="j" multiplier="2" offset="1"/></joint></robot>"""
MJCF = """<mujoco model="m"><compiler angle="radian" eulerseq="XYZ" settotalmass="3"/><option gravity="0 0 -9"/>
<default><joint damping="1"/><default class="x"><geom size=".1"/></default></default><worldbody>
<body name="a" pos="0 0 1" childclass="x"><joint type="free" armature="1"/><geom type="capsule" fromto="0 0 0 1 0 0"/>
<body name="b" euler="1 2 3"><joint name="p" axis="1 0 0" ref="1" stiffness="2" range="-1 1"/>
<joint name="p2" type="slide" springdamper="1 2"/>
<inertial pos="0 0 1" mass="2" fullinertia="1 1 1 0 0 0" quat="1 0 0 1"/><site name="s" pos="1 1 1"/>
<frame pos="1 0 0"><body name="c"><joint type="ball" pos="0 1 0"/><geom type="box" size="1 1 1"/></body></frame></body>
<replicate count="3" offset="1 0 0" euler="0 1 0"><body name="w"><joint/><geom size="1"/></body></replicate>
</body><site name="t"/></worldbody><equality><connect body1="c" body2="a" anchor="0 0 1"/>
<joint joint1="p" joint2="p2" polycoef="1 2 0 0 0"/></equality>
<tendon><fixed stiffness="2" damping="1" springlength="1 2"><joint joint="p" coef="1"/></fixed>
<spatial stiffness="2"><site site="s"/><site site="t"/></spatial></tendon></mujoco>"""
_CORPUS = [
    path.read_bytes() for path in [*urdf_files().values(), *mjcf_files().values()] if path.stat().st_size < 12000
]
SDF = """<sdf version="1.9"><model name="m"><link name="a"/><link name="b">
<pose relative_to="a" degrees="true">0 0 1 0 90 0</pose><inertial><pose>0 0 1 0.1 0.2 0</pose><mass>2</mass>
<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>
<frame name="f" attached_to="b"><pose>0 1 0 0 0 0</pose></frame>
<joint name="j" type="universal"><parent>a</parent><child>b</child>
<axis><xyz expressed_in="f">1 0 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>
<axis2><mimic joint="j" axis="axis"><multiplier>2</multiplier></mimic>
<xyz>0 1 0</xyz><dynamics><damping>1</damping><spring_stiffness>2</spring_stiffness></dynamics></axis2>
</joint></model></sdf>"""
DH = b"""# convention: standard
# length: mm
name,type,a,alpha,d,theta,mass,cx,Ixx,min,max
q1,R,0,0,300,0,3,10,0.1,-90,90
q2,P,50,-90,0,90,2,100,0.1,,
"""
TABLE = b'{"convention": "modified", "angle": "deg", "dh": [{"a": 1, "alpha": 90, "d": 0, "theta": 0, "mass": 2}]}'
PAR = b"""(* Robotname = 'R' *)
NL = 2
NF = 2
ant = {0,1}
sigma = {0,1}
b = {0,0}
d = {0,D2}
r = {0.3,q2 + 0.1}
gamma = {0,0}
alpha = {0,-pi/2}
theta = {q1,pi/6}
XX = {XX1,0.1}
MX = {0.03,MX2*cos(pi/5)}
M = {3,M2}
FV = {0,FV2}
"""
LOOP = b"""NL = 3
NJ = 4
NF = 5
Ant = {0,1,0,
  2,3}
sigma = {0,0,0,0,2}
d = {0,l,3,
  l,sqrt(a**2)}
gamma = {0,0,0,0,-atan2(b, l)}
theta = {t1,t2,t3,t4,0}
M = {1,M2,1}
G = {0,0,G3}
"""
SEEDS: list[bytes] = [*[URDF.encode(), MJCF.encode(), SDF.encode(), DH, TABLE, PAR, LOOP] * 8, *_CORPUS]
