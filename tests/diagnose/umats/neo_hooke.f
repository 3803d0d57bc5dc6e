C     Compressible neo-Hooke, written for these tests: sigma = (mu (b - I) + lambda ln(J) I)/J.
C     PROPS: mu, lambda (MPa), number of the mistake that is planted in DDSDDE (0: none):
C       1 no 1/J      2 no Jaumann terms      3 neither      4 derivative of the Cauchy stress
C       5 Voigt order of the tangent 23, 13, 12               6 the same order of stress and tangent
C       7 shear columns twice (tensor for engineering shear)  8 shear stiffnesses twice
C       9 half the shear columns   10 dS/dE   11 a mistake of no name   12 Jaumann and shear columns
C      with an unsymmetric tangent, from a pressure that grows with b11:
C      13 transposed   14 symmetrised   15 right
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(*),DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS),DRPLDE(NTENS),STRAN(NTENS),DSTRAN(NTENS),TIME(2),
     2 PREDEF(1),DPRED(1),PROPS(NPROPS),COORDS(3),DROT(3,3),
     3 DFGRD0(3,3),DFGRD1(3,3),JSTEP(4)
      DIMENSION B(3,3),S(3,3),D(3,3),C(6,6),FI(3,3),P(6,6),T(6)
      INTEGER IR(6),JC(6),IORD(6)
      DATA IR /1,2,3,1,1,2/, JC /1,2,3,2,3,3/, IORD /1,2,3,6,5,4/
      LOGICAL JAUMANN
      MISTAKE = NINT(PROPS(3))
      JAUMANN = .NOT. (MISTAKE.EQ.2 .OR. MISTAKE.EQ.3 .OR.
     1  MISTAKE.EQ.10 .OR. MISTAKE.EQ.12)
      B = MATMUL(DFGRD1, TRANSPOSE(DFGRD1))
      D = 0.D0
      DO I = 1, 3
        D(I,I) = 1.D0
      END DO
      AJ = DET(DFGRD1)
      AL = PROPS(2)*LOG(AJ)
      S = (PROPS(1)*(B - D) + AL*D)/AJ
      DO M = 1, 6
        DO N = 1, 6
          I = IR(M)
          J = JC(M)
          K = IR(N)
          L = JC(N)
          C(M,N) = (PROPS(2)*D(I,J)*D(K,L) + (PROPS(1) - AL)*
     1      (D(I,K)*D(J,L) + D(I,L)*D(J,K)))/AJ
          IF (JAUMANN) C(M,N) = C(M,N) + 0.5D0*(D(I,K)*S(J,L)
     1      + D(I,L)*S(J,K) + D(J,K)*S(I,L) + D(J,L)*S(I,K))
          IF (MISTAKE.EQ.4) C(M,N) = C(M,N) - S(I,J)*D(K,L)
        END DO
      END DO
      IF (MISTAKE.EQ.1 .OR. MISTAKE.EQ.3) C = AJ*C
      IF (MISTAKE.EQ.7 .OR. MISTAKE.EQ.12) C(:,4:6) = 2.D0*C(:,4:6)
      IF (MISTAKE.EQ.8) C(4:6,4:6) = 2.D0*C(4:6,4:6)
      IF (MISTAKE.EQ.9) C(:,4:6) = 0.5D0*C(:,4:6)
      IF (MISTAKE.EQ.11) C(1,2) = 1.3D0*C(1,2)
      IF (MISTAKE.EQ.5 .OR. MISTAKE.EQ.6) C = C(IORD,IORD)
      IF (MISTAKE.EQ.10) THEN
        FI = COFACTOR(DFGRD1)/AJ
        DO M = 1, 6
          DO N = 1, 6
            P(M,N) = FI(IR(M),IR(N))*FI(JC(M),JC(N))
            IF (N.GT.3) P(M,N) = P(M,N)
     1        + FI(IR(M),JC(N))*FI(JC(M),IR(N))
          END DO
        END DO
        C = AJ*MATMUL(P, MATMUL(C, TRANSPOSE(P)))
      END IF
      DO M = 1, 6
        T(M) = S(IR(M),JC(M))
      END DO
      IF (MISTAKE.GE.13) THEN
C       tau = ... + mu b11 I, so that (1/J) d tau / d eps has mu/J I (x) (2 b11, 0, 0, b12, b13, 0).
        P = 0.D0
        DO M = 1, 3
          T(M) = T(M) + PROPS(1)*B(1,1)/AJ
          P(M,1) = 2.D0*PROPS(1)*B(1,1)/AJ
          P(M,4) = PROPS(1)*B(1,2)/AJ
          P(M,5) = PROPS(1)*B(1,3)/AJ
        END DO
        IF (MISTAKE.EQ.13) P = TRANSPOSE(P)
        IF (MISTAKE.EQ.14) P = 0.5D0*(P + TRANSPOSE(P))
        C = C + P
      END IF
      IF (MISTAKE.EQ.6) T = T(IORD)
      DO M = 1, NTENS
        STRESS(M) = T(M)
        DO N = 1, NTENS
          DDSDDE(M,N) = C(M,N)
        END DO
      END DO
      RETURN

      CONTAINS

      FUNCTION DET(F)
      DOUBLE PRECISION DET, F(3,3)
      DET = F(1,1)*(F(2,2)*F(3,3) - F(2,3)*F(3,2))
     1    - F(1,2)*(F(2,1)*F(3,3) - F(2,3)*F(3,1))
     2    + F(1,3)*(F(2,1)*F(3,2) - F(2,2)*F(3,1))
      END FUNCTION

C     Transposed cofactors: J times the inverse.
      FUNCTION COFACTOR(F)
      DOUBLE PRECISION COFACTOR(3,3), F(3,3)
      INTEGER A, Q, A1, A2, Q1, Q2
      DO A = 1, 3
        DO Q = 1, 3
          A1 = MOD(A,3) + 1
          A2 = MOD(A+1,3) + 1
          Q1 = MOD(Q,3) + 1
          Q2 = MOD(Q+1,3) + 1
          COFACTOR(Q,A) = F(A1,Q1)*F(A2,Q2) - F(A1,Q2)*F(A2,Q1)
        END DO
      END DO
      END FUNCTION
      END
