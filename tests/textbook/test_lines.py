"""What is printed, beside what textbooks print: lines typed by hand, and the source's own arrangement as a formula.

``line`` is what is printed, letter by letter. ``source`` was typed from the publication, as it stands there; both are
compared in ball arithmetic at random points, straight from their texts.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest

from substructures.export import render
from substructures.expr.direct import ball
from substructures.expr.syntax import read

from .textbook_models import program


class Line(NamedTuple):
    """A printed line of an output of a model, and the same in the words of a source."""

    model: str
    output: str
    line: str
    source: str
    origin: str


LANDAU = "L. D. Landau, E. M. Lifshitz, Mechanics, 3rd ed. 1976, section 5, problem 1, with phi2 = q1 + q2"
TEDRAKE = "R. Tedrake, Underactuated Robotics, chapter The acrobot, the cart-pole and quadrotors"
FURUTA = "B. S. Cazzolato, Z. Prime, On the Dynamics of the Furuta Pendulum, 2011, equation 33"
SPONG = (
    "M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, 2006, section 7.4, and a load at the end"
)
TOP = "H. Goldstein, Classical Mechanics, 2nd ed. 1980, sections 5-7 and 8-3, with A + m l^2 about the fixed point"
BLOCH = "A. M. Bloch, Nonholonomic Mechanics and Control, 2003, section 1.7"
PUMA = "sum of the links' moments about axis 2, B. Armstrong, O. Khatib, J. Burdick, ICRA 1986, before abbreviation"

STEINER = "sum of the links' moments, m r^2 each and their own"
ROPE = "a pendulum on a rope of length l0 + hoist below a trolley"

LINK = "a spring between two points at a and hv - lift from the pin, with the law of cosines"
SQUEEZER = "E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 1996, section VI.9, (9.9)"
DE_LEVA = "P. de Leva, Journal of Biomechanics 29(9), 1996, table 4 (male)"

COORDINATES = [f"q{n}" for n in range(1, 7)]

LINES = [
    Line(
        "double-pendulum",
        "metric[1, 1]",
        "(m1 + m2)*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(q2)",
        "(m1 + m2)*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(q1 - (q1 + q2))",
        LANDAU,
    ),
    Line(
        "double-pendulum",
        "forces[1]",
        "tau_1 - (m1 + m2)*g*l1*sin(q1) - m2*g*l2*sin(q1 + q2)",
        "tau_1 - (m1 + m2)*g*l1*sin(q1) - m2*g*l2*sin(q1 + q2)",
        LANDAU,
    ),
    Line("double-pendulum", "christoffel[1, 2, 2]", "-m2*l1*l2*sin(q2)", "-m2*l1*l2*sin(q2)", LANDAU),
    Line(
        "double-pendulum",
        "scalar_curvature",
        "2*m1*cos(q2)/(l1*l2*(m1 + m2*sin(q2)^2)^2)",
        "2*m1*cos(q2)/(l1*l2*(m1 + m2*(1 - cos(q2)^2))^2)",
        "twice Gauss' curvature by Brioschi's formula",
    ),
    Line(
        "double-pendulum",
        "forward_dynamics[1]",
        "(l2*(tau_1 - tau_2) - m1*g*l1*l2*sin(q1) + m2*g*l1*l2*cos(q1 + q2)*sin(q2) - l1*tau_2*cos(q2)"
        " + m2*l1*l2^2*sin(q2)*(q1' + q2')^2 + m2*l1^2*l2*sin(q2)*cos(q2)*q1'^2)/(l1^2*l2*(m1 + m2*sin(q2)^2))",
        # Cramer's rule on M q'' + C = Q
        "(m2*l2^2*(tau_1 - (m1 + m2)*g*l1*sin(q1) - m2*g*l2*sin(q1 + q2) + m2*l1*l2*sin(q2)*(2*q1'*q2' + q2'^2))"
        " - (m2*l2^2 + m2*l1*l2*cos(q2))*(tau_2 - m2*g*l2*sin(q1 + q2) - m2*l1*l2*sin(q2)*q1'^2))"
        "/(m2*l2^2*((m1 + m2)*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(q2)) - (m2*l2^2 + m2*l1*l2*cos(q2))^2)",
        LANDAU,
    ),
    Line(
        "acrobot",
        "metric[1, 1]",
        "Ic1 + Ic2 + m1*lc1^2 + m2*(l1^2 + lc2^2) + 2*m2*l1*lc2*cos(q2)",
        "(Ic1 + m1*lc1^2) + (Ic2 + m2*lc2^2) + m2*l1^2 + 2*m2*l1*lc2*cos(q2)",
        TEDRAKE,
    ),
    Line(
        "acrobot",
        "forces[1]",
        "tau_1 - g*(m1*lc1 + m2*l1)*cos(q1) - m2*g*lc2*cos(q1 + q2)",
        "tau_1 - m1*g*lc1*cos(q1) - m2*g*(l1*cos(q1) + lc2*cos(q1 + q2))",
        TEDRAKE,
    ),
    Line(
        "acrobot",
        "forward_dynamics[1]",
        "((Ic2 + m2*lc2^2)*(tau_1 - tau_2 - g*(m1*lc1 + m2*l1)*cos(q1) + m2*l1*lc2*sin(q2)*(q1' + q2')^2)"
        " - m2*l1*lc2*cos(q2)*(tau_2 - m2*g*lc2*cos(q1 + q2) - m2*l1*lc2*sin(q2)*q1'^2))"
        "/((Ic2 + m2*lc2^2)*(Ic1 + m1*lc1^2 + m2*l1^2) - m2^2*l1^2*lc2^2*cos(q2)^2)",
        # Cramer's rule on M q'' + C = Q
        "((Ic2 + m2*lc2^2)*(tau_1 - g*(m1*lc1 + m2*l1)*cos(q1) - m2*g*lc2*cos(q1 + q2) + m2*l1*lc2*sin(q2)*(2*q1'*q2'"
        " + q2'^2)) - (Ic2 + m2*lc2^2 + m2*l1*lc2*cos(q2))*(tau_2 - m2*g*lc2*cos(q1 + q2) - m2*l1*lc2*sin(q2)*q1'^2))"
        "/((Ic2 + m2*lc2^2)*(Ic1 + m1*lc1^2 + Ic2 + m2*lc2^2 + m2*l1^2 + 2*m2*l1*lc2*cos(q2)) - (Ic2 + m2*lc2^2"
        " + m2*l1*lc2*cos(q2))^2)",
        TEDRAKE,
    ),
    Line(
        "cart-pendulum",
        "forward_dynamics[1]",
        "(l0*tau_0 + tau_1*cos(q1) + m1*g*l0*sin(q1)*cos(q1) - m1*l0^2*sin(q1)*q1'^2)/(l0*(m0 + m1*sin(q1)^2))",
        "1/(m0 + m1*sin(q1)^2)*(tau_0 + tau_1*cos(q1)/l0 - m1*sin(q1)*(l0*q1'^2 - g*cos(q1)))",
        TEDRAKE + ", from the upright position, and a torque",
    ),
    Line(
        "furuta-pendulum",
        "metric[1, 1]",
        "J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2",
        "J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2",
        FURUTA,
    ),
    Line("furuta-pendulum", "metric[1, 2]", "m2*L1*l2*cos(q2)", "m2*L1*l2*cos(q2)", FURUTA),
    Line(
        "furuta-pendulum",
        "christoffel[1, 1, 2]",
        "(J2 + m2*l2^2)*sin(q2)*cos(q2)",
        "1/2*(J2 + m2*l2^2)*sin(2*q2)",
        FURUTA,
    ),
    Line(
        "furuta-pendulum",
        "forward_dynamics[1]",
        "((J2 + m2*l2^2)*(tau_1 - b1*q1' - m2*L1*l2*sin(q2)*(cos(q2)^2*q1'^2 - q2'^2)"
        " - 2*(J2 + m2*l2^2)*sin(q2)*cos(q2)*q1'*q2') - m2*L1*l2*cos(q2)*(tau_2 - m2*g*l2*sin(q2) - b2*q2'))"
        "/((J2 + m2*l2^2)*(J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2) - m2^2*L1^2*l2^2*cos(q2)^2)",
        # Cramer's rule on M q'' + C = Q
        "((J2 + m2*l2^2)*(tau_1 - b1*q1' + m2*L1*l2*sin(q2)*q2'^2 - (J2 + m2*l2^2)*sin(2*q2)*q1'*q2')"
        " - m2*L1*l2*cos(q2)*(tau_2 - b2*q2' - m2*g*l2*sin(q2) + 1/2*(J2 + m2*l2^2)*sin(2*q2)*q1'^2))/((J2"
        " + m2*l2^2)*(J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2) - (m2*L1*l2*cos(q2))^2)",
        FURUTA,
    ),
    Line(
        "scara",
        "metric[1, 1]",
        "I1 + I2 + Ia4 + m1*c1^2 + m2*(a1^2 + c2^2) + (m3 + m4)*(a1^2 + a2^2) + 2*a1*(m2*c2 + (m3 + m4)*a2)*cos(q2)",
        "m1*c1^2 + m2*(a1^2 + c2^2 + 2*a1*c2*cos(q2)) + (m3 + m4)*(a1^2 + a2^2 + 2*a1*a2*cos(q2)) + I1 + I2 + Ia4",
        SPONG,
    ),
    Line("scara", "metric[2, 2]", "I2 + Ia4 + m2*c2^2 + (m3 + m4)*a2^2", "m2*c2^2 + (m3 + m4)*a2^2 + I2 + Ia4", SPONG),
    Line(
        "top",
        "routhian",
        "-m*g*l*cos(theta) - p_phi^2/(2*C) + 1/2*(A + m*l^2)*theta'^2"
        " - (p_psi - p_phi*cos(theta))^2/(2*(A + m*l^2)*sin(theta)^2)",
        "(A + m*l^2)*theta'^2/2 - (p_psi - p_phi*cos(theta))^2/(2*(A + m*l^2)*sin(theta)^2) - p_phi^2/(2*C)"
        " - m*g*l*cos(theta)",
        TOP,
    ),
    Line("sleigh", "bias[2]", "m*a*u*w", "m*a*u*w", BLOCH),
    Line("sleigh", "metric[2, 2]", "I + m*a^2", "I + m*a^2", BLOCH),
    Line(
        "puma560",
        "metric[2, 2]",
        "Iyy3 + Izz2 + Jm2*G2^2 + m2*((a2 + cx2)^2 + cy2^2) + m3*(a2^2 + (a3 + cx3)^2 + cz3^2)"
        " + m4*(a2^2 + a3^2 + (cy4 + d4)^2) + (m5 + m6)*(a2^2 + a3^2 + d4^2)"
        " + 2*a2*((m3 + m4 + m5 + m6)*a3 + m3*cx3)*c3 - 2*m6*a2*cz6*(c3*c4*s5 + s3*c5)"
        " - 2*a2*(m3*cz3 + m4*cy4 + (m4 + m5 + m6)*d4)*s3 - 2*m6*a3*cz6*c4*s5 + (Iyy5 + Izz4)*c4^2"
        " + m6*cz6^2*(c4^2 + s4^2*c5^2) + Iyy6*(c4*c6 - s4*c5*s6)^2 + Ixx6*(c4*s6 + s4*c5*c6)^2 + Ixx4*s4^2"
        " + Ixx5*s4^2*c5^2 + (Izz5 + Izz6)*s4^2*s5^2 + 2*m6*cz6*d4*c5",
        "Jm2*G2^2 + Izz2 + m2*((a2 + cx2)^2 + cy2^2)"
        " + Iyy3 + m3*((a2 + c3*(a3 + cx3) - s3*cz3)^2 + (s3*(a3 + cx3) + c3*cz3)^2)"
        " + Ixx4*s4^2 + Izz4*c4^2 + m4*((a2 + c3*a3 - s3*(d4 + cy4))^2 + (s3*a3 + c3*(d4 + cy4))^2)"
        " + Ixx5*(s4*c5)^2 + Iyy5*c4^2 + Izz5*(s4*s5)^2 + m5*((a2 + c3*a3 - s3*d4)^2 + (s3*a3 + c3*d4)^2)"
        " + Ixx6*(s4*c5*c6 + c4*s6)^2 + Iyy6*(s4*c5*s6 - c4*c6)^2 + Izz6*(s4*s5)^2"
        " + m6*((a2 + c3*(a3 - cz6*c4*s5) - s3*(d4 + cz6*c5))^2 + (s3*(a3 - cz6*c4*s5) + c3*(d4 + cz6*c5))^2)",
        PUMA,
    ),
    Line("andrews-squeezer", "metric[5, 5]", "I4 + m4*(e - ea)^2", "I4 + m4*(e - ea)^2", STEINER),
    Line(
        "planar-3r",
        "metric[1, 2]",
        "I2 + I3 + m2*c2^2 + m3*(c3^2 + l2^2) + l1*(m2*c2 + m3*l2)*cos(q2) + m3*c3*l1*cos(q2 + q3)"
        " + 2*m3*c3*l2*cos(q3)",
        "I2 + m2*(c2^2 + l1*c2*cos(q2)) + I3 + m3*(l2^2 + c3^2 + 2*l2*c3*cos(q3) + l1*l2*cos(q2) + l1*c3*cos(q2 + q3))",
        STEINER,
    ),
    Line(
        "four-bar",
        "metric[1, 1]",
        "(1/3*m1 + m2)*l1^2 + 1/3*m2*l2^2 + m2*l1*l2*cos(coupler)",
        "m1*l1^2/3 + m2*(l1^2 + l2^2/4 + l1*l2*cos(coupler)) + m2*l2^2/12",
        STEINER,
    ),
    Line("trolley-crane", "metric[1, 2]", "ml*(l0 + hoist)*cos(swing)", "ml*(l0 + hoist)*cos(swing)", ROPE),
    Line("trolley-crane", "metric[2, 2]", "ml*(l0 + hoist)^2", "ml*(l0 + hoist)^2", ROPE),
    Line("trolley-crane", "christoffel[2, 2, 3]", "ml*(l0 + hoist)", "ml*(l0 + hoist)", ROPE),
    Line(
        "acrobot",
        "scalar_curvature",
        "2*m2*l1*lc2*((Ic1 + m1*lc1^2)*(Ic2 + m2*lc2^2) + Ic2*m2*l1^2)*cos(q2)"
        "/((Ic2 + m2*lc2^2)*(Ic1 + m1*lc1^2 + m2*l1^2) - m2^2*l1^2*lc2^2*cos(q2)^2)^2",
        # 2*d*(a*b - d^2)*cos(q2)/det^2 for the metric a + b + 2*d*cos(q2), b + d*cos(q2), b
        "2*m2*l1*lc2*((Ic1 + m1*lc1^2 + m2*l1^2)*(Ic2 + m2*lc2^2) - (m2*l1*lc2)^2)*cos(q2)"
        "/((Ic1 + m1*lc1^2 + m2*l1^2)*(Ic2 + m2*lc2^2) - (m2*l1*lc2*cos(q2))^2)^2",
        "twice Gauss' curvature by Brioschi's formula",
    ),
    Line(
        "acrobot",
        "energy",
        "g*(m1*lc1 + m2*l1)*sin(q1) + m2*g*lc2*sin(q1 + q2) + 1/2*(Ic1 + m1*lc1^2 + m2*l1^2)*q1'^2"
        " + 1/2*(Ic2 + m2*lc2^2)*(q1' + q2')^2 + m2*l1*lc2*cos(q2)*q1'*(q1' + q2')",
        "(Ic1 + m1*lc1^2)*q1'^2/2 + (m2*l1^2 + Ic2 + m2*lc2^2 + 2*m2*l1*lc2*cos(q2))*q1'^2/2 + (Ic2 + m2*lc2^2)*q2'^2/2"
        " + (Ic2 + m2*lc2^2 + m2*l1*lc2*cos(q2))*q1'*q2' + m1*g*lc1*sin(q1) + m2*g*(l1*sin(q1) + lc2*sin(q1 + q2))",
        TEDRAKE + ", from the horizontal",
    ),
    Line(
        "acrobot",
        "hamiltonian",
        "g*(m1*lc1 + m2*l1)*sin(q1) + m2*g*lc2*sin(q1 + q2) + ((Ic2 + m2*lc2^2)*(p_1 - p_2)^2"
        " + (Ic1 + m1*lc1^2 + m2*l1^2)*p_2^2 - 2*m2*l1*lc2*p_2*(p_1 - p_2)*cos(q2))/(2*((Ic2 + m2*lc2^2)*(Ic1"
        " + m1*lc1^2 + m2*l1^2) - m2^2*l1^2*lc2^2*cos(q2)^2))",
        # p M^-1 p by Cramer's rule, and the potential energy from the horizontal
        "m1*g*lc1*sin(q1) + m2*g*(l1*sin(q1) + lc2*sin(q1 + q2)) + ((Ic2 + m2*lc2^2)*p_1^2 - 2*(Ic2 + m2*lc2^2"
        " + m2*l1*lc2*cos(q2))*p_1*p_2 + (Ic1 + m1*lc1^2 + Ic2 + m2*lc2^2 + m2*l1^2 + 2*m2*l1*lc2*cos(q2))*p_2^2)"
        "/(2*((Ic2 + m2*lc2^2)*(Ic1 + m1*lc1^2 + Ic2 + m2*lc2^2 + m2*l1^2 + 2*m2*l1*lc2*cos(q2)) - (Ic2 + m2*lc2^2"
        " + m2*l1*lc2*cos(q2))^2))",
        TEDRAKE,
    ),
    Line(
        "furuta-pendulum",
        "hamiltonian",
        "-m2*g*l2*cos(q2) + ((J1 + m1*l1^2 + m2*L1^2)*p_2^2 + (J2 + m2*l2^2)*(p_1^2 + p_2^2*sin(q2)^2)"
        " - 2*m2*L1*l2*p_1*p_2*cos(q2))/(2*((J2 + m2*l2^2)*(J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2)"
        " - m2^2*L1^2*l2^2*cos(q2)^2))",
        "((J2 + m2*l2^2)*p_1^2 - 2*m2*L1*l2*cos(q2)*p_1*p_2 + (J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2)"
        "*p_2^2)/(2*((J2 + m2*l2^2)*(J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2) - (m2*L1*l2*cos(q2))^2))"
        " - m2*g*l2*cos(q2)",
        FURUTA,
    ),
    Line(
        "cart-pendulum",
        "energy",
        "m1*g*l0*cos(q1) + 1/2*(m0 + m1)*q0'^2 - m1*l0*cos(q1)*q0'*q1' + 1/2*m1*l0^2*q1'^2",
        "(m0 + m1)*q0'^2/2 - m1*l0*cos(q1)*q0'*q1' + m1*l0^2*q1'^2/2 + m1*g*l0*cos(q1)",
        TEDRAKE + ", from the upright position",
    ),
    Line(
        "scara",
        "forward_dynamics[4]",
        "tau_4/Ia4 + ((I1 + m1*c1^2 + (m2 + m3 + m4)*a1^2 + a1*(m2*c2 + (m3 + m4)*a2)*cos(q2))"
        "*(tau_2 + tau_4 - a1*(m2*c2 + (m3 + m4)*a2)*sin(q2)*q1'^2) - a1*(m2*c2 + (m3 + m4)*a2)*cos(q2)"
        "*(tau_1 + tau_4 + a1*(m2*c2 + (m3 + m4)*a2)*sin(q2)*q2'*(2*q1' + q2')))"
        "/((I2 + m2*c2^2 + (m3 + m4)*a2^2)*(I1 + m1*c1^2 + (m2 + m3 + m4)*a1^2)"
        " - a1^2*(m2*c2 + (m3 + m4)*a2)^2*cos(q2)^2)",
        # q4'' = tau_4/Ia4 + q1'' + q2'', and Cramer's rule on both links with tau_4 on the second
        "tau_4/Ia4 + ((I1 + m1*c1^2 + (m2 + m3 + m4)*a1^2 + a1*(m2*c2 + (m3 + m4)*a2)*cos(q2))"
        "*(tau_2 + tau_4 - a1*(m2*c2 + (m3 + m4)*a2)*sin(q2)*q1'^2)"
        " - a1*(m2*c2 + (m3 + m4)*a2)*cos(q2)"
        "*(tau_1 + tau_4 + a1*(m2*c2 + (m3 + m4)*a2)*sin(q2)*(2*q1'*q2' + q2'^2)))"
        "/((I1 + m1*c1^2 + (m2 + m3 + m4)*a1^2)*(I2 + m2*c2^2 + (m3 + m4)*a2^2)"
        " - (a1*(m2*c2 + (m3 + m4)*a2)*cos(q2))^2)",
        SPONG,
    ),
    Line(
        "symmetric-top",
        "energy",
        "m*g*l*cos(theta) + 1/2*C*(phi' + cos(theta)*psi')^2 + 1/2*(A + m*l^2)*(sin(theta)^2*psi'^2 + theta'^2)",
        "(A + m*l^2)*(theta'^2 + psi'^2*sin(theta)^2)/2 + C*(phi' + psi'*cos(theta))^2/2 + m*g*l*cos(theta)",
        TOP,
    ),
    Line("symmetric-top", "momentum.x.phi", "C*(phi' + cos(theta)*psi')", "C*(phi' + psi'*cos(theta))", TOP),
    Line(
        "gimbal-gyroscope",
        "angular_momentum.z",
        "(Izo + (Iar + Izi)*cos(nutation)^2 + (Itr + Iyi)*sin(nutation)^2)*precession' + Iar*cos(nutation)*spin'",
        "(Izo + Izi*cos(nutation)^2 + (Iyi + Itr)*sin(nutation)^2)*precession'"
        " + Iar*cos(nutation)*(spin' + precession'*cos(nutation))",
        "moments of both gimbals about the vertical, and of the rotor",
    ),
    Line(
        "trolley-crane",
        "energy",
        "-ml*g*(l0 + hoist)*cos(swing) + 1/2*(md + ml)*hoist'^2 + ml*sin(swing)*hoist'*x'"
        " + 1/2*ml*(l0 + hoist)^2*swing'^2 + ml*(l0 + hoist)*cos(swing)*swing'*x' + 1/2*(ml + mt)*x'^2",
        "mt*x'^2/2 + md*hoist'^2/2 + ml*((x' + hoist'*sin(swing) + (l0 + hoist)*swing'*cos(swing))^2"
        " + (hoist'*cos(swing) - (l0 + hoist)*swing'*sin(swing))^2)/2 - ml*g*(l0 + hoist)*cos(swing)",
        ROPE,
    ),
    Line(
        "free-body",
        "energy",
        "m*g*z + 1/2*Iyy*(cos(roll)*pitch' + cos(pitch)*sin(roll)*yaw')^2"
        " + 1/2*Izz*(sin(roll)*pitch' - cos(pitch)*cos(roll)*yaw')^2 + 1/2*Ixx*(roll' - sin(pitch)*yaw')^2"
        " + 1/2*m*(x'^2 + y'^2 + z'^2)",
        "m*(x'^2 + y'^2 + z'^2)/2 + m*g*z + (Ixx*(roll' - yaw'*sin(pitch))^2"
        " + Iyy*(pitch'*cos(roll) + yaw'*cos(pitch)*sin(roll))^2"
        " + Izz*(yaw'*cos(pitch)*cos(roll) - pitch'*sin(roll))^2)/2",
        "yaw, pitch and roll in H. Goldstein, Classical Mechanics, 3rd ed. 2002, appendix A",
    ),
    Line(
        "trolley-crane",
        "forward_dynamics[3]",
        "(mt*tau_hoist + ml*mt*g*cos(swing) - ml*sin(swing)*(tau_x - b*x') + ml*tau_hoist*sin(swing)^2"
        " + ml*mt*(l0 + hoist)*swing'^2)/((md + ml)*mt + md*ml*sin(swing)^2)"
        " + ml*tau_swing*sin(swing)*cos(swing)/((l0 + hoist)*((md + ml)*mt + md*ml*sin(swing)^2))",
        # elimination of x'' and swing''
        "((mt + ml*sin(swing)^2)*(tau_hoist + ml*g*cos(swing) + ml*(l0 + hoist)*swing'^2)"
        " - ml*sin(swing)*(tau_x - b*x' + ml*(l0 + hoist)*sin(swing)*swing'^2)"
        " + ml*sin(swing)*cos(swing)*(tau_swing/(l0 + hoist) - ml*g*sin(swing)))/((md + ml)*mt + md*ml*sin(swing)^2)",
        ROPE,
    ),
    Line(
        "free-body",
        "christoffel[4, 5, 6]",
        "-1/2*cos(pitch)*(Ixx - (Iyy - Izz)*cos(2*roll))",
        "-Ixx*cos(pitch)/2 + (Iyy - Izz)*cos(pitch)*(cos(roll)^2 - sin(roll)^2)/2",
        "half the derivative of g by roll, pitch and yaw",
    ),
    Line(
        "acrobot",
        "forward_dynamics[2]",
        "((Ic1 + m1*lc1^2 + m2*l1^2 + m2*l1*lc2*cos(q2))*(tau_2 - m2*g*lc2*cos(q1 + q2) - m2*l1*lc2*sin(q2)*q1'^2)"
        " - (Ic2 + m2*lc2^2 + m2*l1*lc2*cos(q2))*(tau_1 - tau_2 - g*(m1*lc1 + m2*l1)*cos(q1)"
        " + m2*l1*lc2*sin(q2)*(q1' + q2')^2))/((Ic2 + m2*lc2^2)*(Ic1 + m1*lc1^2 + m2*l1^2)"
        " - m2^2*l1^2*lc2^2*cos(q2)^2)",
        # Cramer's rule on M q'' + C = Q
        "((Ic1 + m1*lc1^2 + Ic2 + m2*lc2^2 + m2*l1^2 + 2*m2*l1*lc2*cos(q2))*(tau_2 - m2*g*lc2*cos(q1 + q2)"
        " - m2*l1*lc2*sin(q2)*q1'^2) - (Ic2 + m2*lc2^2 + m2*l1*lc2*cos(q2))*(tau_1 - g*(m1*lc1 + m2*l1)*cos(q1)"
        " - m2*g*lc2*cos(q1 + q2) + m2*l1*lc2*sin(q2)*(2*q1'*q2' + q2'^2)))/((Ic2 + m2*lc2^2)*(Ic1 + m1*lc1^2 + Ic2"
        " + m2*lc2^2 + m2*l1^2 + 2*m2*l1*lc2*cos(q2)) - (Ic2 + m2*lc2^2 + m2*l1*lc2*cos(q2))^2)",
        TEDRAKE,
    ),
    Line(
        "cart-pendulum",
        "forward_dynamics[2]",
        "((m0 + m1)*(tau_1 + m1*g*l0*sin(q1)) + m1*l0*cos(q1)*(tau_0 - m1*l0*sin(q1)*q1'^2))"
        "/(m1*l0^2*(m0 + m1*sin(q1)^2))",
        "1/(l0*(m0 + m1*sin(q1)^2))*((m0 + m1)*tau_1/(m1*l0) + tau_0*cos(q1) - m1*l0*q1'^2*cos(q1)*sin(q1)"
        " + (m0 + m1)*g*sin(q1))",
        TEDRAKE + ", from the upright position, and a torque",
    ),
    Line(
        "furuta-pendulum",
        "forward_dynamics[2]",
        "((J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2)*(tau_2 - m2*g*l2*sin(q2) - b2*q2'"
        " + (J2 + m2*l2^2)*sin(q2)*cos(q2)*q1'^2) - m2*L1*l2*cos(q2)*(tau_1 - b1*q1'"
        " - 2*(J2 + m2*l2^2)*sin(q2)*cos(q2)*q1'*q2' + m2*L1*l2*sin(q2)*q2'^2))"
        "/((J2 + m2*l2^2)*(J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2) - m2^2*L1^2*l2^2*cos(q2)^2)",
        # Cramer's rule on M q'' + C = Q
        "((J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2)*(tau_2 - b2*q2' - m2*g*l2*sin(q2)"
        " + 1/2*(J2 + m2*l2^2)*sin(2*q2)*q1'^2) - m2*L1*l2*cos(q2)*(tau_1 - b1*q1' + m2*L1*l2*sin(q2)*q2'^2"
        " - (J2 + m2*l2^2)*sin(2*q2)*q1'*q2'))/((J2 + m2*l2^2)*(J1 + m1*l1^2 + m2*L1^2 + (J2 + m2*l2^2)*sin(q2)^2)"
        " - (m2*L1*l2*cos(q2))^2)",
        FURUTA,
    ),
    Line(
        "pan-tilt",
        "forward_dynamics[2]",
        "(tau_tilt + mt*ct*g*cos(tilt) + (Ixt - Iyt - mt*ct^2)*sin(tilt)*cos(tilt)*pan'^2)/(Iyt + mt*ct^2)",
        "(tau_tilt + mt*g*ct*cos(tilt) - 1/2*(Iyt + mt*ct^2 - Ixt)*sin(2*tilt)*pan'^2)/(Iyt + mt*ct^2)",
        STEINER + ", half the derivative of that about the axis of pan",
    ),
    Line(
        "stewart-leg",
        "forward_dynamics[2]",
        "(tau_beta + g*(mc*cc - mr*(cr - l0 - extension))*cos(alpha)*sin(beta)"
        " + 2*mr*(cr - l0 - extension)*beta'*extension' + (Iac + Iar - Itc - Itr - mc*cc^2"
        " - mr*(cr - l0 - extension)^2)*sin(beta)*cos(beta)*alpha'^2)/(Itc + Itr + mc*cc^2 + mr*(cr - l0"
        " - extension)^2)",
        # with e = l0 + extension - cr from the joint to the mass centre of the rod
        "(tau_beta + (mc*cc + mr*(l0 + extension - cr))*g*cos(alpha)*sin(beta) - 2*mr*(l0 + extension - cr)*extension'"
        "*beta' - ((Itc + mc*cc^2) + (Itr + mr*(l0 + extension - cr)^2) - (Iac + Iar))*cos(beta)*sin(beta)*alpha'^2)"
        "/((Itc + mc*cc^2) + (Itr + mr*(l0 + extension - cr)^2))",
        STEINER,
    ),
    Line(
        "quarter-car",
        "forward_dynamics[2]",
        "(1/M1 + 1/M2)*(tau_body - K1*body - b1*body') - (tau_wheel + K2*(road - wheel) + b2*(road_rate - wheel'))/M2",
        # body is the difference of both heights
        "(tau_body - K1*body - b1*body')/M1 - (tau_wheel - tau_body + K2*(road - wheel) + b2*(road_rate - wheel')"
        " + K1*body + b1*body')/M2",
        "two masses, and a spring and a damper for the tyre",
    ),
    Line(
        "humanoid-head",
        "forward_dynamics[2]",
        "tau_neck_pitch/(0.024222337776*M*l^2) + 4.25*g*sin(neck_pitch)/(2.9679*l)"
        " + 108527/138502*sin(neck_pitch)*cos(neck_pitch)*neck_yaw'^2",
        # moments about the cervicale, with the mass centre at 0.4998 l and radii of gyration 0.303, 0.315 and 0.261 l
        "(tau_neck_pitch + 0.0694*M*g*0.4998*l*sin(neck_pitch) + 0.0694*M*l^2*(0.303^2 + 0.4998^2 - 0.261^2)"
        "*sin(neck_pitch)*cos(neck_pitch)*neck_yaw'^2)/(0.0694*M*l^2*(0.315^2 + 0.4998^2))",
        DE_LEVA,
    ),
    Line(
        "humanoid-head",
        "forward_dynamics[1]",
        "(6.25*tau_neck_yaw - 0.2372508747*M*l^2*sin(neck_pitch)*cos(neck_pitch)*neck_pitch'*neck_yaw')"
        "/(0.015615*M*l^2*(9.48914 - 7.59689*cos(neck_pitch)^2))",
        "(tau_neck_yaw - 2*0.0694*M*l^2*(0.303^2 + 0.4998^2 - 0.261^2)*sin(neck_pitch)*cos(neck_pitch)"
        "*neck_pitch'*neck_yaw')/(0.0694*M*l^2*((0.303^2 + 0.4998^2)*sin(neck_pitch)^2 + 0.261^2*cos(neck_pitch)^2))",
        DE_LEVA,
    ),
    Line(
        "flyball-governor",
        "metric[1, 1]",
        "Is + Iv + mb*((r + l*sin(left))^2 + (r + l*sin(right))^2)",
        "Is + Iv + mb*(r + l*sin(left))^2 + mb*(r + l*sin(right))^2",
        STEINER,
    ),
    Line(
        "satellite",
        "metric[5, 5]",
        "1/6*mp*wp^2 + mp*lp*r*sin(roll)*(sin(left + roll) - sin(right - roll))"
        " + 1/3*mp*lp^2*(sin(left + roll)^2 + sin(right - roll)^2) + Iyy*cos(roll)^2 + (Izz + 2*mp*r^2)*sin(roll)^2",
        "Iyy*cos(roll)^2 + Izz*sin(roll)^2 + mp*((r*sin(roll) + lp*sin(left + roll)/2)^2 + lp^2*sin(left + roll)^2/12"
        " + wp^2/12) + mp*((r*sin(roll) - lp*sin(right - roll)/2)^2 + lp^2*sin(right - roll)^2/12 + wp^2/12)",
        STEINER,
    ),
    Line(
        "flyball-governor",
        "forces[2]",
        "tau_right - mb*g*l*sin(right) - a*kl*(hv - lift)*sin(right)*(t1 - ll)/t1",
        "tau_right - mb*g*l*sin(right) - kl*(sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(right)) - ll)"
        "*a*(hv - lift)*sin(right)/sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(right))",
        LINK,
    ),
    Line(
        "flyball-governor",
        "forces[4]",
        "tau_lift - mv*g - k*lift + kl*(hv - a*cos(left) - lift)*(t2 - ll)/t2"
        " + kl*(hv - a*cos(right) - lift)*(t1 - ll)/t1",
        "tau_lift - mv*g - k*lift + kl*(1 - ll/sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(left)))"
        "*(hv - lift - a*cos(left)) + kl*(1 - ll/sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(right)))"
        "*(hv - lift - a*cos(right))",
        LINK,
    ),
    Line(
        "flyball-governor",
        "potential_energy",
        "-mv*g*hv - mb*g*l*(cos(left) + cos(right)) + mv*g*lift + 1/2*k*lift^2"
        " + 1/2*kl*((sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(left)) - ll)^2"
        " + (sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(right)) - ll)^2)",
        "k*lift^2/2 - mv*g*(hv - lift) - mb*g*l*cos(left) - mb*g*l*cos(right)"
        " + kl*(sqrt((hv - lift - a*cos(left))^2 + a^2*sin(left)^2) - ll)^2/2"
        " + kl*(sqrt((hv - lift - a*cos(right))^2 + a^2*sin(right)^2) - ll)^2/2",
        LINK,
    ),
    Line(
        "drill-spindle",
        "potential_energy",
        "1/2*m*g*l + m*g*feed + 1/2*k*(feed - r)^2",
        "m*g*(feed + l/2) + k*(feed - r)^2/2",
        "a weight on a spring that is unloaded at r",
    ),
    Line(
        "andrews-squeezer",
        "potential_energy",
        "-mom*beta + 1/2*c0*(sqrt(sc^2 + sd^2 + (xb - xc)^2 + (yb - yc)^2 - 2*(sc*yb - sc*yc - sd*xb"
        " + sd*xc)*cos(gamma) + 2*(sc*xb - sc*xc + sd*yb - sd*yc)*sin(gamma)) - l0)^2",
        "-mom*beta + c0*(sqrt((sd*cos(gamma) + sc*sin(gamma) + xb - xc)^2 + (sd*sin(gamma) - sc*cos(gamma)"
        " + yb - yc)^2) - l0)^2/2",
        SQUEEZER,
    ),
    Line(
        "andrews-squeezer",
        "forces[3]",
        "tau_gamma - c0*((sc*xb - sc*xc + sd*yb - sd*yc)*cos(gamma) + (sc*yb - sc*yc - sd*xb + sd*xc)*sin(gamma))"
        "*(t1 - l0)/t1",
        # F = c0*(L - l0)/L, and F*(xD - xc), F*(yD - yc) on the point D
        "tau_gamma - c0*(1 - l0/sqrt((sd*cos(gamma) + sc*sin(gamma) + xb - xc)^2 + (sd*sin(gamma) - sc*cos(gamma) + yb"
        " - yc)^2))*((sd*cos(gamma) + sc*sin(gamma) + xb - xc)*(sc*cos(gamma) - sd*sin(gamma))"
        " + (sd*sin(gamma) - sc*cos(gamma) + yb - yc)*(sd*cos(gamma) + sc*sin(gamma)))",
        SQUEEZER,
    ),
]


@pytest.mark.parametrize("case", LINES, ids=lambda case: f"{case.model} {case.output}")
def test_lines_of_textbooks(case: Line) -> None:
    name = case.output.partition("[")[0]
    text = render(program(case.model, name), "text", "textbook")
    printed = dict(line.split(" = ", 1) for line in text.splitlines() if " = " in line and not line.startswith("#"))
    assert printed[case.output] == case.line
    # abbreviations such as c23, then everything else at random
    names = {step.value for step in [*read(case.line), *read(case.source)] if step.op == "name"}
    rng = np.random.default_rng(5)
    for _ in range(3):
        point = {n: Fraction(int(rng.integers(100, 900)), 400) for n in [*sorted(map(str, names)), *COORDINATES]}
        point |= {n: ball(printed[n], point, precision=300) for n in printed if n in names}
        one, two = (ball(text, point, precision=300) for text in (case.line, case.source))
        assert (one - two).contains(0)
        assert float((one - two).rad()) < 1e-60
