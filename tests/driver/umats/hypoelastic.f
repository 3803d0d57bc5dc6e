C     Linear elasticity in rate form, written for the tests: the stress that Abaqus has turned by
C     DROT, plus 2 mu DSTRAN + lambda tr(DSTRAN) I. PROPS: mu, lambda (MPa).
C     STATEV 1-6: STRAN + DSTRAN as passed.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'header.inc'
      CHARACTER*80 CMNAME
      DOUBLE PRECISION TR
      INTEGER I,J
      TR = DSTRAN(1) + DSTRAN(2) + DSTRAN(3)
      DDSDDE = 0.D0
      DO I = 1, NTENS
        STATEV(I) = STRAN(I) + DSTRAN(I)
        IF (I .LE. 3) THEN
          STRESS(I) = STRESS(I) + 2.D0*PROPS(1)*DSTRAN(I) + PROPS(2)*TR
          DO J = 1, 3
            DDSDDE(I,J) = PROPS(2)
          END DO
          DDSDDE(I,I) = 2.D0*PROPS(1) + PROPS(2)
        ELSE
          STRESS(I) = STRESS(I) + PROPS(1)*DSTRAN(I)
          DDSDDE(I,I) = PROPS(1)
        END IF
      END DO
      END
